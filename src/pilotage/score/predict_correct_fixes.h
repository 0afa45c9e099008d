#pragma once

#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/mission/tile_scores.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/score/score_tiles.h"

namespace pilotage {

/// Fills map_features, vote_noise and p_correct_fix of scored tiles of `matrix`, whose statistics are there. Flat tiles
/// have P = 0; those with too little ground have none. Throws as count_self_votes and read_matchability_model.
void predict_correct_fixes(const GraySource& source, const TileMatrix& matrix, const ScoreOptions& options,
                           std::vector<TileScore>& scores, int threads, const Progress& progress);

}  // namespace pilotage
