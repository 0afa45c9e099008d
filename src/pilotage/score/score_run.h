#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/base/progress.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/mission/mission.h"
#include "pilotage/score/run_shards.h"
#include "pilotage/score/score_ground.h"

namespace pilotage {

/// The options of a run of `score`.
struct ScoreRunOptions {
  RasterGridOptions grid;  ///< Of rasters; a plan refuses them.
  ScoreOptions score;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    RasterGridOptions::describe(self.grid, fields);
    ScoreOptions::describe(self.score, fields);
  }
};

/// A run of `score` before any tile is scored: everything that its result follows from. Of a plan (one input whose name
/// ends in ".json") or of rasters.
struct ScoreRun {
  std::vector<std::string> inputs;
  ScoreRunOptions options;
  std::uint64_t seed = 1;
  Ground ground;                 ///< Of rasters it has no tiles: there may be more than one machine wants.
  std::optional<Flight> flight;  ///< Of a plan.
  std::vector<std::string> warnings;
};

/// Throws as read_plan and ground_of_rasters; UsageError when options of the raster grid are given with a plan.
ScoreRun open_score_run(const std::vector<std::string>& inputs, const ScoreRunOptions& options, std::uint64_t seed,
                        const Progress& progress = {});

std::int64_t tile_count(const ScoreRun& run);

/// The tiles of a shard, in the order of the cut. Throws as run_shards.h says.
std::vector<ShardTile> shard_tiles(const ScoreRun& run, const Shard& shard);

/// The run's ground with the tiles at `places` (ascending; run_shards.h), or with all of them.
Ground part_of_ground(const ScoreRun& run, const std::vector<std::int64_t>& places, int threads = 0);
Ground whole_ground(const ScoreRun& run, int threads = 0);

}  // namespace pilotage
