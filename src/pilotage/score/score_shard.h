#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/ground/tile_scores.h"
#include "pilotage/score/run_shards.h"

namespace pilotage {

/// The result of one shard of a run of `score`, as a file holds it (schemas/score-shard.md).
struct ScoreShard {
  nlohmann::ordered_json run;  ///< What the run is: describe_run (describe_run.h). Shards of one run have equal ones.
  Shard shard;
  /// Ascending tile_id. Of each: tile_id, status, valid_fraction and measures(), bit for bit; level, column, row
  /// and reasons follow from the run and are not in the file.
  std::vector<TileScore> scores;
};

/// "scores-03-of-16.shard": sorts by number.
std::string shard_file_name(const Shard& shard);

/// The file's bytes. Columns that are NaN for all tiles are left out.
std::string score_shard_to_bytes(const ScoreShard& shard);

/// Reads what score_shard_to_bytes writes. Throws IntegrityError when the digest at the end is not that of the bytes
/// (truncated, or changed), DataError when they are no shard, one of a later version, or hold what no shard holds; all
/// name `name`.
ScoreShard score_shard_from_bytes(const std::string& name, std::string_view bytes);

/// The same of a file. Throws also DataError when it cannot be read.
ScoreShard read_score_shard(const std::string& file);

}  // namespace pilotage
