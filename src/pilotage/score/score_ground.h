#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/ground/ground.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/score/score_second_epoch.h"
#include "pilotage/score/score_tiles.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What scoring a ground gives.
struct GroundScores {
  std::vector<TileScores> scores;           ///< Of all tiles, in the order of ground.tiles.
  std::optional<SecondEpoch> second_epoch;  ///< When options.second_epoch is given.
};

/// Scores every tile of a ground, level by level: all that follows, one after the other. Tile sizes, strides and search
/// radii are those of its levels. `imagery` is the ground's where it is open already, for this stage and others. The
/// same bytes for any number of threads. Throws as score_ground_tiles and register_second_epoch.
GroundScores score_ground(const Ground& ground, const ScoreOptions& options, std::uint64_t seed = 1, int threads = 0,
                          const Progress& progress = {}, const GroundImagery* imagery = nullptr);

/// The scores of a ground's tiles but for their reasons; what a second date says when its registration's field is
/// given. A tile's scores do not depend on which others the ground has, so that a part of a run is a ground with some
/// of its tiles. Throws as score_tiles, open_imagery, measure_ground_cover and score_epochs.
std::vector<TileScores> score_ground_tiles(const Ground& ground, const ScoreOptions& options,
                                           const WarpField* second_epoch, std::uint64_t seed = 1, int threads = 0,
                                           const Progress& progress = {}, const GroundImagery* imagery = nullptr);

/// Fills the reasons of all tiles; scores[i] is of ground.tiles[i]. To be called when all numbers are there.
void explain_scores(const Ground& ground, std::vector<TileScores>& scores, int threads = 0);

}  // namespace pilotage

#pragma GCC visibility pop
