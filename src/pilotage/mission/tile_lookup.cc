#include "pilotage/mission/tile_lookup.h"

#include <cmath>

namespace pilotage {

std::int64_t tile_id_of(const std::vector<PlanLevel>& levels, int level, std::int64_t column, std::int64_t row) {
  std::int64_t first_id = 0;
  for (int finer = 0; finer < level; ++finer) first_id += levels[static_cast<std::size_t>(finer)].matrix.tile_count();
  return first_id + levels[static_cast<std::size_t>(level)].matrix.index_of(column, row);
}

TileLookup::TileLookup(const TilePlan& plan) : plan_(plan) {
  index_of_id_.reserve(plan.tiles.size());
  for (std::size_t i = 0; i < plan.tiles.size(); ++i) index_of_id_.emplace(plan.tiles[i].tile_id, i);
}

std::optional<std::size_t> TileLookup::tile_under(const PlanSample& sample) const {
  if (sample.level == PlanSample::kNoLevel) return std::nullopt;
  const TileMatrix& matrix = plan_.levels[static_cast<std::size_t>(sample.level)].matrix;
  const Eigen::Vector2d pixel = matrix.map_from_pixel.pixel_from_map(sample.point_map_m);
  const double half_px = matrix.tile_size_px / 2.0;
  const auto column = static_cast<std::int64_t>(std::llround((pixel.x() - half_px) / matrix.stride_px));
  const auto row = static_cast<std::int64_t>(std::llround((pixel.y() - half_px) / matrix.stride_px));
  if (!matrix.contains(column, row)) return std::nullopt;
  const auto found = index_of_id_.find(tile_id_of(plan_.levels, sample.level, column, row));
  if (found == index_of_id_.end()) return std::nullopt;
  return found->second;
}

}  // namespace pilotage
