#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/mission.h"
#include "pilotage/score/score_second_epoch.h"
#include "pilotage/score/score_tiles.h"

namespace pilotage {

struct ScoredPlan {
  std::vector<TileScore> scores;            ///< One per tile, in the order of plan.ground.tiles.
  std::optional<SecondEpoch> second_epoch;  ///< When options.second_epoch is given; its scores are in `scores` too.
};

/// Registers options.second_epoch over all tiles of the plan. Throws as register_epochs.
SecondEpoch register_second_epoch(const Mission& plan, const ScoreOptions& options, int threads = 0,
                                  const Progress& progress = {});

/// Scores the tiles at `places` of plan.ground.tiles (ascending), level by level; tile size, stride and search radius
/// are the plan's. Everything but the reasons is filled; what a second date says when its registration's field is
/// given. The same for a tile whichever others are asked for. Throws as score_tiles, open_gray_on_grid and
/// score_epochs.
std::vector<TileScore> score_plan_tiles(const Mission& plan, const ScoreOptions& options,
                                        const std::vector<std::int64_t>& places, const WarpField* second_epoch,
                                        std::uint64_t seed = 1, int threads = 0, const Progress& progress = {});

/// Fills the reasons of the scores of all tiles, in the order of plan.ground.tiles.
void explain_plan(const Mission& plan, std::vector<TileScore>& scores);

/// Scores every tile of a plan on its imagery: all of the above.
ScoredPlan score_plan(const Mission& plan, const ScoreOptions& options, std::uint64_t seed = 1, int threads = 0,
                      const Progress& progress = {});

}  // namespace pilotage
