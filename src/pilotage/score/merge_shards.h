#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/score/score_run.h"

namespace pilotage {

/// The files of shards that are named: files as they are, of folders what ends in ".shard", sorted. Throws DataError
/// when something does not exist or a folder holds none.
std::vector<std::string> shard_files(const std::vector<std::string>& names);

/// The shards of a run, put together.
struct MergedShards {
  ScoreRun run;  ///< Opened again; its files are those that the shards were made of.
  std::int64_t count = 0;
  std::vector<std::int64_t> missing;  ///< Numbers of shards that are not among the files, ascending.
  std::vector<TileScores> scores;     ///< Of all tiles in the order of places; complete when none is missing.
};

/// Reads shards, any number and in any order. Throws IntegrityError for one that is damaged; DataError when two are of
/// different runs, have different counts or the same number, when their run's inputs are not what they were, or were
/// scored by another version than `software_version`, and when a shard has other tiles than it should.
MergedShards read_shards(const std::vector<std::string>& files, const std::string& software_version,
                         const Progress& progress = {});

}  // namespace pilotage
