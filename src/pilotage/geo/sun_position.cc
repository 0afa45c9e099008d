#include "pilotage/geo/sun_position.h"

#include <cmath>
#include <numbers>

#include "pilotage/base/angle.h"

namespace pilotage {
namespace {

double between_0_and_360(double angle_deg) {
  return angle_deg - 360 * std::floor(angle_deg / 360);
}

}  // namespace

SunPosition sun_position(GeodeticPoint point, UtcTime time) {
  constexpr UtcTime kJ2000Noon =
      UtcTime(std::chrono::sys_days(std::chrono::January / 1 / 2000)) + std::chrono::hours(12);
  const double days = static_cast<double>((time - kJ2000Noon).count()) / 86400;
  const double centuries = days / 36525;

  // The sun's apparent longitude: mean longitude, equation of the centre, nutation and aberration.
  const double mean_longitude_deg = 280.46646 + centuries * (36000.76983 + centuries * 0.0003032);
  const double mean_anomaly_rad = (357.52911 + centuries * (35999.05029 - centuries * 0.0001537)) * kRadPerDeg;
  const double center_deg = (1.914602 - centuries * (0.004817 + centuries * 0.000014)) * std::sin(mean_anomaly_rad) +
                            (0.019993 - centuries * 0.000101) * std::sin(2 * mean_anomaly_rad) +
                            0.000289 * std::sin(3 * mean_anomaly_rad);
  const double node_rad = (125.04 - 1934.136 * centuries) * kRadPerDeg;
  const double longitude_rad = (mean_longitude_deg + center_deg - 0.00569 - 0.00478 * std::sin(node_rad)) * kRadPerDeg;
  const double obliquity_rad =
      (23.4392911 - centuries * (0.0130042 + centuries * (0.00000016 - centuries * 0.000000504)) +
       0.00256 * std::cos(node_rad)) *
      kRadPerDeg;

  const double right_ascension_rad =
      std::atan2(std::cos(obliquity_rad) * std::sin(longitude_rad), std::cos(longitude_rad));
  const double declination_rad = std::asin(std::sin(obliquity_rad) * std::sin(longitude_rad));
  const double sidereal_deg = 280.46061837 + 360.98564736629 * days + centuries * centuries * 0.000387933;
  const double hour_angle_rad = (sidereal_deg + point.lon_deg) * kRadPerDeg - right_ascension_rad;

  const double lat_rad = point.lat_deg * kRadPerDeg;
  const double north = std::cos(lat_rad) * std::sin(declination_rad) -
                       std::sin(lat_rad) * std::cos(declination_rad) * std::cos(hour_angle_rad);
  const double east = -std::cos(declination_rad) * std::sin(hour_angle_rad);
  const double up = std::sin(lat_rad) * std::sin(declination_rad) +
                    std::cos(lat_rad) * std::cos(declination_rad) * std::cos(hour_angle_rad);
  return {between_0_and_360(std::atan2(east, north) / kRadPerDeg),
          std::atan2(up, std::hypot(north, east)) / kRadPerDeg};
}

}  // namespace pilotage
