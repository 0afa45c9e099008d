#include "pilotage/mission/tile_under.h"

#include <cmath>

namespace pilotage {

std::optional<std::size_t> tile_under(const Mission& mission, const FlightSample& sample) {
  if (sample.level == FlightSample::kNoLevel) return std::nullopt;
  const std::vector<GridLevel>& levels = mission.ground.levels;
  const TileMatrix& matrix = levels[static_cast<std::size_t>(sample.level)].matrix;
  const Eigen::Vector2d pixel = matrix.map_from_pixel.pixel_from_map(sample.point_map_m);
  const double half_px = matrix.tile_size_px / 2.0;
  const auto column = static_cast<std::int64_t>(std::llround((pixel.x() - half_px) / matrix.stride_px));
  const auto row = static_cast<std::int64_t>(std::llround((pixel.y() - half_px) / matrix.stride_px));
  if (!matrix.contains(column, row)) return std::nullopt;
  return find_tile(mission.ground, tile_id_of(levels, sample.level, column, row));
}

}  // namespace pilotage
