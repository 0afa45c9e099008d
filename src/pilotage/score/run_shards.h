#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/base/shard.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/ground.h"

namespace pilotage {

/// A tile of a run as the cut sees it.
struct ShardTile {
  std::int64_t place = 0;  ///< In the order in which the whole run gives its scores: ascending tile_id.
  int level = 0;
  std::int64_t column = 0;
  std::int64_t row = 0;

  bool operator==(const ShardTile&) const = default;
};

/// Tiles are ordered by level, by group of this many columns, by row, by column: roughly how they are worked on, so
/// that neighbours, which share their pixels and transforms, stay together.
inline constexpr std::int64_t kShardColumns = 64;

/// The tiles of a shard in that order (shard_ranks). All tiles of a matrix (place = row · matrix_width + column), or
/// those of a plan (ascending tile_id; place = index). Throws as shard_ranks.
std::vector<ShardTile> shard_tiles(const TileMatrix& matrix, const Shard& shard);
std::vector<ShardTile> shard_tiles(const std::vector<GroundTile>& tiles, const Shard& shard);

/// Tiles of one level and one group of columns that follow one another, and the rectangle around them.
struct ShardPart {
  int level = 0;
  std::int64_t first_column = 0;
  std::int64_t last_column = 0;
  std::int64_t first_row = 0;
  std::int64_t last_row = 0;
  std::int64_t tiles = 0;
};

/// What a shard is made of, for people.
std::vector<ShardPart> shard_parts(const std::vector<ShardTile>& tiles);

}  // namespace pilotage
