#pragma once

#include <vector>

#include "pilotage/camera/terrain_heights.h"
#include "pilotage/capture/adjust_block.h"

namespace pilotage {

/// The ground under a block, on a grid in its local frame.
struct GroundSurface {
  TerrainHeights heights;
  double spread_m =
      0;  ///< Robust standard deviation of the adjusted points around it: what it leaves out of the relief.
};

/// A smooth surface through the points of a block (least squares with Cauchy's weights; the differences of the slope
/// from node to node are kept small, which also fills where no point lies), over the rectangle `low` … `high` of east
/// and north, in at most 64 nodes a side. Throws DataError for fewer than ten points.
GroundSurface fit_surface(const std::vector<AdjustedPoint>& points, const Eigen::Vector2d& low,
                          const Eigen::Vector2d& high);

/// The heights of `ground` on such a grid, `spacing_m` apart or wider (at most 512 nodes a side); where it knows none,
/// those of fit_surface().
GroundSurface sample_surface(const GroundPrior& ground, double spacing_m, const std::vector<AdjustedPoint>& points,
                             const Eigen::Vector2d& low, const Eigen::Vector2d& high);

}  // namespace pilotage
