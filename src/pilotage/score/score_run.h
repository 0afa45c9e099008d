#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/mission/mission.h"
#include "pilotage/score/run_shards.h"
#include "pilotage/score/score_imagery.h"

namespace pilotage {

/// A run of `score` before any tile is scored: everything that its result follows from, opened. A plan (one input whose
/// name ends in ".json") or rasters; exactly one of `plan` and `imagery` is there.
struct ScoreRun {
  std::vector<std::string> inputs;
  ScoreImageryOptions options;  ///< Grid, imagery, gsd_m and crs are the plan's when there is one.
  std::uint64_t seed = 1;
  std::optional<Mission> plan;
  std::optional<OpenImagery> imagery;
};

/// Throws as read_plan and open_imagery.
ScoreRun open_score_run(const std::vector<std::string>& inputs, const ScoreImageryOptions& options, std::uint64_t seed);

std::int64_t tile_count(const ScoreRun& run);

/// The tiles of a shard, in the order of the cut. Throws as run_shards.h says.
std::vector<ShardTile> shard_tiles(const ScoreRun& run, const Shard& shard);

/// The scores of tiles (ascending places; without reasons), and the registration behind them when there is a second
/// date. It is found from all tiles, whichever are scored, so that parts of a run agree.
struct PartScores {
  std::vector<TileScore> scores;
  std::optional<SecondEpoch> second_epoch;  ///< Its own `scores` are empty.
};
PartScores score_part(const ScoreRun& run, const std::vector<std::int64_t>& places, int threads = 0,
                      const Progress& progress = {});

/// The registration alone; nothing without a second date.
std::optional<SecondEpoch> register_second_epoch(const ScoreRun& run, int threads = 0, const Progress& progress = {});

/// A whole run's result.
struct ScoredRun {
  Crs crs;
  std::vector<TileRow> rows;  ///< All tiles, ascending tile_id.
  std::vector<std::string> warnings;
  std::optional<SecondEpoch> second_epoch;
};

/// Puts together what the scores of all tiles (in the order of places) and the registration give. The scores' level,
/// column and row are filled in. Closes the run's imagery, so that the rows can have the memory of its decoded blocks:
/// nothing more can be scored.
ScoredRun finish_run(ScoreRun& run, PartScores all, int threads = 0);

/// Scores all tiles; closes the imagery as finish_run does.
ScoredRun score_run(ScoreRun& run, int threads = 0, const Progress& progress = {});

}  // namespace pilotage
