#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pilotage/geo/tile_matrix.h"

namespace pilotage {

/// A point of the route on the mission grid.
struct GridSample {
  Eigen::Vector2d point_m;  ///< CRS of the mission grid.
  double distance_m = 0;    ///< Along the route.
};

struct CorridorTile {
  std::int64_t column = 0;
  std::int64_t row = 0;
  double route_distance_m = 0;  ///< Along the route, at the point of the route nearest to the tile's centre.
  double route_offset_m = 0;    ///< From that point to the tile's centre.
};

/// The tiles of `matrix` whose centre lies within `half_width_m` of the polyline through the samples of each run,
/// ascending in (row, column), each once. A run of one sample is a point. Where the route passes a tile more than once,
/// the nearest passage counts (the earlier one on a tie). Tiles outside the matrix are left out.
std::vector<CorridorTile> corridor_tiles(const std::vector<std::vector<GridSample>>& runs, double half_width_m,
                                         const TileMatrix& matrix);

}  // namespace pilotage
