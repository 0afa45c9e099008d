#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "pilotage/geo/geodesic.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage::testing {

/// Grid convergence: the direction of grid north, degrees clockwise from true north, in (-180, 180]. From 100 m of
/// geodesic, error below 1e-5 degrees away from the poles. NaN where the point has no image.
inline double grid_convergence_deg(const Crs& crs, GeodeticPoint point) {
  const CrsTransform transform(crs);
  const auto ahead = transform.map_from_geodetic(geodesic_direct(point, 0, 50));
  const auto behind = transform.map_from_geodetic(geodesic_direct(point, 180, 50));
  if (!ahead || !behind) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector2d north = *ahead - *behind;  // true north, as the grid sees it
  return -std::atan2(north.x(), north.y()) * 180 / std::numbers::pi;
}

}  // namespace pilotage::testing
