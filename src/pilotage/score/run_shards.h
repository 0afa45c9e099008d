#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/ground.h"

namespace pilotage {

/// A part of the tiles of a run of `score`, for one machine of several (docs/scale.md).
struct Shard {
  std::int64_t number = 1;  ///< 1 … count.
  std::int64_t count = 1;

  bool operator==(const Shard&) const = default;
};

/// More shards than anybody will want; keeps arithmetic in range.
inline constexpr std::int64_t kMostShards = 1'000'000;

/// The value of an environment variable, or nothing.
using Environment = std::function<std::optional<std::string>(const std::string& name)>;

/// "3/16" is the third of 16 shards. "auto/16" takes the number from the scheduler: SLURM_ARRAY_TASK_ID as it is (an
/// array 1-16), JOB_COMPLETION_INDEX (Kubernetes) and AWS_BATCH_JOB_ARRAY_INDEX, which count from 0, plus one. Throws
/// UsageError for anything else, and for auto when none or several of them are set, or the number is not 1 … count.
Shard parse_shard(const std::string& text, const Environment& environment);

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

/// The tiles of a shard in that order: of N tiles those with ranks ⌊N (number − 1)/count⌋ up to, not including,
/// ⌊N number/count⌋, so that shards differ by at most one tile. All tiles of a matrix (place = row · matrix_width +
/// column), or those of a plan (ascending tile_id; place = index). Throws UsageError when there are more shards than
/// tiles, or the number is not 1 … count.
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

/// "1,3-5,9": numbers that ascend, as `sbatch --array` takes them.
std::string number_list(const std::vector<std::int64_t>& numbers);

}  // namespace pilotage
