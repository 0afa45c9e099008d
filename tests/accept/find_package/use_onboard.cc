#include <cmath>

#include <pilotage/base/random.h>
#include <pilotage/geo/local_frame.h>

// One arc minute of latitude at 45° north is 1852.2 m on WGS 84; the program fails when the library does not say so.
int main() {
  const pilotage::LocalFrame frame({.lon_deg = 7.0, .lat_deg = 45.0});
  const auto enu_m = frame.enu_from_geodetic({.lon_deg = 7.0, .lat_deg = 45.0 + 1.0 / 60.0});
  const bool random_is_fine = pilotage::Random(1).uniform() < 1.0;
  return std::abs(enu_m.y() - 1852.2) < 1.0 && random_is_fine ? 0 : 1;
}
