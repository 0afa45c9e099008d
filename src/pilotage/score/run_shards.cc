#include "pilotage/score/run_shards.h"

#include <algorithm>
#include <tuple>

namespace pilotage {

std::vector<ShardTile> shard_tiles(const TileMatrix& matrix, const Shard& shard) {
  const std::int64_t width = matrix.matrix_width();
  const std::int64_t height = matrix.matrix_height();
  const auto [begin, end] = shard_ranks(matrix.tile_count(), shard, "tile");
  std::vector<ShardTile> tiles;
  tiles.reserve(static_cast<std::size_t>(end - begin));
  for (std::int64_t rank = begin; rank < end; ++rank) {
    const std::int64_t first_column = rank / (kShardColumns * height) * kShardColumns;
    const std::int64_t columns = std::min(kShardColumns, width - first_column);
    const std::int64_t in_group = rank - first_column * height;
    const std::int64_t row = in_group / columns;
    const std::int64_t column = first_column + in_group % columns;
    tiles.push_back({row * width + column, matrix.level, column, row});
  }
  return tiles;
}

std::vector<ShardTile> shard_tiles(const std::vector<GroundTile>& tiles, const Shard& shard) {
  std::vector<ShardTile> all;
  all.reserve(tiles.size());
  for (const GroundTile& tile : tiles) {
    all.push_back({static_cast<std::int64_t>(all.size()), tile.level, tile.column, tile.row});
  }
  const auto key = [](const ShardTile& tile) {
    return std::tuple(tile.level, tile.column / kShardColumns, tile.row, tile.column);
  };
  std::sort(all.begin(), all.end(), [&](const ShardTile& a, const ShardTile& b) { return key(a) < key(b); });
  const auto [begin, end] = shard_ranks(static_cast<std::int64_t>(all.size()), shard, "tile");
  return {all.begin() + begin, all.begin() + end};
}

std::vector<ShardPart> shard_parts(const std::vector<ShardTile>& tiles) {
  std::vector<ShardPart> parts;
  for (const ShardTile& tile : tiles) {
    const bool same = !parts.empty() && parts.back().level == tile.level &&
                      parts.back().first_column / kShardColumns == tile.column / kShardColumns;
    if (!same) parts.push_back({tile.level, tile.column, tile.column, tile.row, tile.row, 0});
    ShardPart& part = parts.back();
    part.first_column = std::min(part.first_column, tile.column);
    part.last_column = std::max(part.last_column, tile.column);
    part.last_row = tile.row;
    ++part.tiles;
  }
  return parts;
}

}  // namespace pilotage
