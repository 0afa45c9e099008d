#pragma once

#include <Eigen/Core>

#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

// Earth-centred, Earth-fixed coordinates on WGS 84: x to longitude 0 on the equator, z to the north pole, metres.

/// A point at `height_m` above the ellipsoid.
Eigen::Vector3d ecef_from_geodetic(GeodeticPoint point, double height_m);

/// The point of the ellipsoid straight below or above; below 1e-14 rad for heights from -10 km to 100 km (B. R.
/// Bowring, "Transformation from spatial to geographical coordinates", Survey Review 23, 1976).
GeodeticPoint geodetic_from_ecef(const Eigen::Vector3d& ecef_m);

/// Height above the ellipsoid, to a few nanometres of what `point` (geodetic_from_ecef) leaves open.
double height_from_ecef(const Eigen::Vector3d& ecef_m, GeodeticPoint point);

/// Turns vectors into east, north, up of a point.
Eigen::Matrix3d enu_from_ecef(GeodeticPoint point);

}  // namespace pilotage
