#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/mission/tile_plan.h"
#include "pilotage/mission/tile_scores.h"
#include "pilotage/score/score_second_epoch.h"
#include "pilotage/score/score_tiles.h"

namespace pilotage {

struct ScoredPlan {
  std::vector<TileScore> scores;            ///< One per tile, in the order of plan.tiles.
  std::optional<SecondEpoch> second_epoch;  ///< When options.second_epoch is given; its scores are in `scores` too.
};

/// Scores every tile of a plan on its imagery, level by level; tile size, stride and search radius are the plan's.
/// Throws as score_tiles, open_gray_on_grid and compare_epochs_of_plan.
ScoredPlan score_plan(const TilePlan& plan, const ScoreOptions& options, std::uint64_t seed = 1,
                                  int threads = 0, const Progress& progress = {});

}  // namespace pilotage
