#include "pilotage/tile/corridor.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace pilotage {
namespace {

struct NearestPoint {
  double offset_m;
  double fraction;  // of the segment
};

NearestPoint nearest_on_segment(const Eigen::Vector2d& point, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const Eigen::Vector2d along = to - from;
  const double length2 = along.squaredNorm();
  const double fraction = length2 > 0 ? std::clamp((point - from).dot(along) / length2, 0.0, 1.0) : 0.0;
  return {(point - (from + fraction * along)).norm(), fraction};
}

// The indices i of [0, count) whose tile centre i·stride + size/2 lies in [low, high].
std::pair<std::int64_t, std::int64_t> index_range(double low_px, double high_px, const TileMatrix& matrix,
                                                  std::int64_t count) {
  const double half_px = matrix.tile_size_px / 2.0;
  const auto first = static_cast<std::int64_t>(std::ceil((low_px - half_px) / matrix.stride_px));
  const auto last = static_cast<std::int64_t>(std::floor((high_px - half_px) / matrix.stride_px));
  return {std::max<std::int64_t>(0, first), std::min(count - 1, last)};
}

}  // namespace

std::vector<CorridorTile> corridor_tiles(const std::vector<std::vector<GridSample>>& runs, double half_width_m,
                                         const TileMatrix& matrix) {
  std::map<std::pair<std::int64_t, std::int64_t>, CorridorTile> tiles;  // by (row, column)
  const double half_px = matrix.tile_size_px / 2.0;

  const auto add_segment = [&](const GridSample& from, const GridSample& to) {
    const Eigen::Vector2d margin(half_width_m, half_width_m);
    const Eigen::Vector2d low = from.point_m.cwiseMin(to.point_m) - margin;
    const Eigen::Vector2d high = from.point_m.cwiseMax(to.point_m) + margin;
    const Eigen::Vector2d a = matrix.map_from_pixel.pixel_from_map(low);
    const Eigen::Vector2d b = matrix.map_from_pixel.pixel_from_map(high);
    const auto [first_column, last_column] =
        index_range(std::min(a.x(), b.x()), std::max(a.x(), b.x()), matrix, matrix.matrix_width());
    const auto [first_row, last_row] =
        index_range(std::min(a.y(), b.y()), std::max(a.y(), b.y()), matrix, matrix.matrix_height());
    for (std::int64_t row = first_row; row <= last_row; ++row) {
      for (std::int64_t column = first_column; column <= last_column; ++column) {
        const Eigen::Vector2d center =
            matrix.map_from_pixel.map_from_pixel({static_cast<double>(column * matrix.stride_px) + half_px,
                                                  static_cast<double>(row * matrix.stride_px) + half_px});
        const NearestPoint nearest = nearest_on_segment(center, from.point_m, to.point_m);
        if (nearest.offset_m > half_width_m) continue;
        const CorridorTile tile{column, row, from.distance_m + nearest.fraction * (to.distance_m - from.distance_m),
                                nearest.offset_m};
        const auto [it, inserted] = tiles.try_emplace({row, column}, tile);
        if (!inserted && tile.route_offset_m < it->second.route_offset_m) it->second = tile;
      }
    }
  };

  for (const auto& run : runs) {
    if (run.size() == 1) add_segment(run.front(), run.front());
    for (std::size_t i = 1; i < run.size(); ++i) add_segment(run[i - 1], run[i]);
  }
  std::vector<CorridorTile> result;
  result.reserve(tiles.size());
  for (const auto& [key, tile] : tiles) result.push_back(tile);
  return result;
}

}  // namespace pilotage
