#pragma once

#include <Eigen/Core>

#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

/// A local tangent frame on the WGS 84 ellipsoid: x = east, y = north, z = up, in metres, with its origin at a geodetic
/// point and ellipsoidal height. Exact (no small-area approximation); agrees with GeographicLib's LocalCartesian to
/// 1e-8 m within 1,000 km and heights from -10 km to 100 km. Needs no library, so the onboard half can use it.
class LocalFrame {
 public:
  /// `height_m` above the ellipsoid. Throws UsageError when the point is not finite or |lat| > 90.
  explicit LocalFrame(GeodeticPoint origin, double height_m = 0);

  GeodeticPoint origin() const { return origin_; }

  /// East, north, up of a point at `height_m` above the ellipsoid.
  Eigen::Vector3d enu_from_geodetic(GeodeticPoint point, double height_m = 0) const;

  /// The point (lon in [-180, 180)) that lies at east, north, up; its height is left out.
  GeodeticPoint geodetic_from_enu(const Eigen::Vector3d& enu_m) const;

 private:
  GeodeticPoint origin_;
  Eigen::Vector3d origin_ecef_m_;
  Eigen::Matrix3d enu_from_ecef_;
};

}  // namespace pilotage
