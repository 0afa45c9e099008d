#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/ground/tile_table.h"
#include "pilotage/score/run_shards.h"

namespace pilotage {

/// The result of one shard of a run of `score`, as a file holds it (schemas/score-shard.md).
struct ScoreShard {
  nlohmann::ordered_json run;  ///< What the run is: describe_run (describe_run.h). Shards of one run have equal ones.
  Shard shard;
  std::vector<TileRow> rows;  ///< Ascending tile_id; their reasons, which follow from all tiles, are left to `merge`.
};

/// "scores-03-of-16.shard": sorts by number.
std::string shard_file_name(const Shard& shard);

/// The file's bytes: what the shard is, and its rows as tiles.csv has them.
std::string score_shard_to_bytes(const ScoreShard& shard);

/// Reads what score_shard_to_bytes writes. Throws IntegrityError when the digest at the end is not that of the bytes
/// (truncated, or changed), DataError when they are no shard, one of a later version, or hold what no shard holds; all
/// name `name`.
ScoreShard score_shard_from_bytes(const std::string& name, std::string_view bytes);

/// The same of a file. Throws also DataError when it cannot be read.
ScoreShard read_score_shard(const std::string& file);

}  // namespace pilotage
