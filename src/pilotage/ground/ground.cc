#include "pilotage/ground/ground.h"

#include <algorithm>

#include "pilotage/base/error.h"

namespace pilotage {

std::int64_t tile_id_of(const std::vector<GridLevel>& levels, int level, std::int64_t column, std::int64_t row) {
  std::int64_t first_id = 0;
  for (int finer = 0; finer < level; ++finer) first_id += levels[static_cast<std::size_t>(finer)].matrix.tile_count();
  return first_id + levels[static_cast<std::size_t>(level)].matrix.index_of(column, row);
}

std::optional<std::size_t> find_tile(const Ground& ground, std::int64_t tile_id) {
  const auto tile =
      std::lower_bound(ground.tiles.begin(), ground.tiles.end(), tile_id,
                       [](const GroundTile& candidate, std::int64_t id) { return candidate.tile_id < id; });
  if (tile == ground.tiles.end() || tile->tile_id != tile_id) return std::nullopt;
  return static_cast<std::size_t>(tile - ground.tiles.begin());
}

std::size_t tile_index(const Ground& ground, std::int64_t tile_id, const std::string& what) {
  if (const auto index = find_tile(ground, tile_id)) return *index;
  throw DataError(what + ": tile " + std::to_string(tile_id) + " is not among the " +
                  std::to_string(ground.tiles.size()) + " tiles of the plan");
}

}  // namespace pilotage
