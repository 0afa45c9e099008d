#include "pilotage/geo/geodetic_point.h"

#include <cmath>

namespace pilotage {

double wrap_lon_deg(double lon_deg) {
  const double wrapped = std::remainder(lon_deg, 360.0);
  return wrapped == 180.0 ? -180.0 : wrapped;
}

double unwrap_lon_deg(double lon_deg, double reference_deg) {
  return reference_deg + std::remainder(lon_deg - reference_deg, 360.0);
}

}  // namespace pilotage
