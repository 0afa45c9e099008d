#include "pilotage/geo/local_frame.h"

#include <cmath>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr double kSemiMajor_m = 6378137.0;           // WGS 84
constexpr double kFlattening = 1.0 / 298.257223563;  // WGS 84
constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);

Eigen::Vector3d ecef_from_geodetic(GeodeticPoint point, double height_m) {
  const double lat = point.lat_deg * kRadPerDeg;
  const double lon = point.lon_deg * kRadPerDeg;
  const double normal_m = kSemiMajor_m / std::sqrt(1.0 - kEccentricity2 * std::sin(lat) * std::sin(lat));
  return {(normal_m + height_m) * std::cos(lat) * std::cos(lon), (normal_m + height_m) * std::cos(lat) * std::sin(lon),
          (normal_m * (1.0 - kEccentricity2) + height_m) * std::sin(lat)};
}

// B. R. Bowring, "Transformation from spatial to geographical coordinates", Survey Review 23 (1976): the iteration on
// the reduced latitude; three rounds are below 1e-15 rad for heights from -10 km to 100 km.
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

}  // namespace

LocalFrame::LocalFrame(GeodeticPoint origin, double height_m) : origin_(origin) {
  if (!std::isfinite(origin.lon_deg) || !std::isfinite(height_m) || !(std::abs(origin.lat_deg) <= 90.0)) {
    throw UsageError("local frame at lon " + format_number(origin.lon_deg) + ", lat " + format_number(origin.lat_deg) +
                     ", height " + format_number(height_m) + ": not a place on Earth");
  }
  const double lat = origin.lat_deg * kRadPerDeg;
  const double lon = origin.lon_deg * kRadPerDeg;
  origin_ecef_m_ = ecef_from_geodetic(origin, height_m);
  enu_from_ecef_ << -std::sin(lon), std::cos(lon), 0,                                 //
      -std::sin(lat) * std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat),  //
      std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat);
}

Eigen::Vector3d LocalFrame::enu_from_geodetic(GeodeticPoint point, double height_m) const {
  return enu_from_ecef_ * (ecef_from_geodetic(point, height_m) - origin_ecef_m_);
}

GeodeticPoint LocalFrame::geodetic_from_enu(const Eigen::Vector3d& enu_m) const {
  return geodetic_from_ecef(origin_ecef_m_ + enu_from_ecef_.transpose() * enu_m);
}

}  // namespace pilotage
