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

/// Registers options.second_epoch over all tiles of the plan. Throws as register_epochs.
SecondEpoch register_second_epoch(const TilePlan& plan, const ScoreOptions& options, int threads = 0,
                                  const Progress& progress = {});

/// Scores the tiles at `places` of plan.tiles (ascending), level by level; tile size, stride and search radius are the
/// plan's. Everything but the reasons is filled; what a second date says when its registration's field is given. The
/// same for a tile whichever others are asked for. Throws as score_tiles, open_gray_on_grid and score_epochs.
std::vector<TileScore> score_plan_tiles(const TilePlan& plan, const ScoreOptions& options,
                                        const std::vector<std::int64_t>& places, const WarpField* second_epoch,
                                        std::uint64_t seed = 1, int threads = 0, const Progress& progress = {});

/// Fills the reasons of the scores of all tiles, in the order of plan.tiles.
void explain_plan(const TilePlan& plan, std::vector<TileScore>& scores);

/// Scores every tile of a plan on its imagery: all of the above.
ScoredPlan score_plan(const TilePlan& plan, const ScoreOptions& options, std::uint64_t seed = 1, int threads = 0,
                      const Progress& progress = {});

}  // namespace pilotage
