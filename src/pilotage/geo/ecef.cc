#include "pilotage/geo/ecef.h"

#include <cmath>

#include "pilotage/base/angle.h"

namespace pilotage {
namespace {

constexpr double kSemiMajor_m = 6378137.0;           // WGS 84
constexpr double kFlattening = 1.0 / 298.257223563;  // WGS 84
constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);

}  // namespace

Eigen::Vector3d ecef_from_geodetic(GeodeticPoint point, double height_m) {
  const double lat = point.lat_deg * kRadPerDeg;
  const double lon = point.lon_deg * kRadPerDeg;
  const double normal_m = kSemiMajor_m / std::sqrt(1.0 - kEccentricity2 * std::sin(lat) * std::sin(lat));
  return {(normal_m + height_m) * std::cos(lat) * std::cos(lon), (normal_m + height_m) * std::cos(lat) * std::sin(lon),
          (normal_m * (1.0 - kEccentricity2) + height_m) * std::sin(lat)};
}

// The iteration on the reduced latitude; three rounds are below 1e-15 rad for heights from -10 km to 100 km.
GeodeticPoint geodetic_from_ecef(const Eigen::Vector3d& ecef_m) {
  constexpr double kSemiMinor_m = kSemiMajor_m * (1.0 - kFlattening);
  constexpr double kSecondEccentricity2 = kEccentricity2 / (1.0 - kEccentricity2);
  const double axis_distance_m = std::hypot(ecef_m.x(), ecef_m.y());
  double reduced = std::atan2(ecef_m.z(), (1.0 - kFlattening) * axis_distance_m);
  double lat = 0;
  for (int round = 0; round < 3; ++round) {
    const double s = std::sin(reduced);
    const double c = std::cos(reduced);
    lat = std::atan2(ecef_m.z() + kSecondEccentricity2 * kSemiMinor_m * s * s * s,
                     axis_distance_m - kEccentricity2 * kSemiMajor_m * c * c * c);
    reduced = std::atan2((1.0 - kFlattening) * std::sin(lat), std::cos(lat));
  }
  return {.lon_deg = wrap_lon_deg(std::atan2(ecef_m.y(), ecef_m.x()) / kRadPerDeg), .lat_deg = lat / kRadPerDeg};
}

double height_from_ecef(const Eigen::Vector3d& ecef_m, GeodeticPoint point) {
  // Along the normal, on which the point lies.
  const double lat = point.lat_deg * kRadPerDeg;
  const double lon = point.lon_deg * kRadPerDeg;
  const Eigen::Vector3d up(std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat));
  return up.dot(ecef_m - ecef_from_geodetic(point, 0));
}

Eigen::Matrix3d enu_from_ecef(GeodeticPoint point) {
  const double lat = point.lat_deg * kRadPerDeg;
  const double lon = point.lon_deg * kRadPerDeg;
  Eigen::Matrix3d rotation;
  rotation << -std::sin(lon), std::cos(lon), 0,                                       //
      -std::sin(lat) * std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat),  //
      std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat);
  return rotation;
}

}  // namespace pilotage
