#include "pilotage/mission/tile_lookup.h"

#include <cmath>

namespace pilotage {

TileLookup::TileLookup(const Mission& plan) : plan_(plan) {
  index_of_id_.reserve(plan.ground.tiles.size());
  for (std::size_t i = 0; i < plan.ground.tiles.size(); ++i) index_of_id_.emplace(plan.ground.tiles[i].tile_id, i);
}

std::optional<std::size_t> TileLookup::tile_under(const FlightSample& sample) const {
  if (sample.level == FlightSample::kNoLevel) return std::nullopt;
  const TileMatrix& matrix = plan_.ground.levels[static_cast<std::size_t>(sample.level)].matrix;
  const Eigen::Vector2d pixel = matrix.map_from_pixel.pixel_from_map(sample.point_map_m);
  const double half_px = matrix.tile_size_px / 2.0;
  const auto column = static_cast<std::int64_t>(std::llround((pixel.x() - half_px) / matrix.stride_px));
  const auto row = static_cast<std::int64_t>(std::llround((pixel.y() - half_px) / matrix.stride_px));
  if (!matrix.contains(column, row)) return std::nullopt;
  const auto found = index_of_id_.find(tile_id_of(plan_.ground.levels, sample.level, column, row));
  if (found == index_of_id_.end()) return std::nullopt;
  return found->second;
}

}  // namespace pilotage
