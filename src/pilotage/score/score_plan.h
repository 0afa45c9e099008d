#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/mission/tile_plan.h"
#include "pilotage/mission/tile_scores.h"
#include "pilotage/score/score_tiles.h"

namespace pilotage {

/// Scores every tile of a plan on its imagery, level by level; tile size, stride and search radius are the plan's. One
/// score per tile, in the order of plan.tiles. Throws as score_tiles and open_gray_on_grid.
std::vector<TileScore> score_plan(const TilePlan& plan, const ScoreOptions& options, std::uint64_t seed = 1,
                                  int threads = 0, const Progress& progress = {});

}  // namespace pilotage
