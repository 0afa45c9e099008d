#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/ground.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/score/score_tiles.h"

namespace pilotage {

/// The parameters of P that the options ask for, the default model for the age of the imagery where it is known. Throws
/// as read_matchability_model, and DataError when they have none for the matcher.
MatchabilityModel model_for(const ScoreOptions& options);

/// Fills map_features, vote_noise, fine_contrast, p_correct_fix, level_sigma, level_tiles and level_age_months of
/// scored tiles of `matrix`, whose statistics are there: scores[i] is of the tile with index tile_indices[i]. Flat
/// tiles have P = 0; those with too little ground have none. `shown` is the map in 8 bits (stretch_to_8bit),
/// `usual_contrast` the fine contrast that ground has there (usual_fine_contrast for windows of a tile's size). Throws
/// as count_self_votes.
void predict_correct_fixes(const GraySource& shown, const TileMatrix& matrix, const ScoreOptions& options,
                           const MatchabilityModel& model, std::span<const std::int64_t> tile_indices,
                           std::vector<TileScores>& scores, double usual_contrast, int threads,
                           const Progress& progress);

/// The options for a ground of one level with what its P is held against (ScoreOptions::usual_fine_contrast) measured
/// where they do not say it: scores are the same with it as without. As they are where no P is asked for, or no window
/// of the ground counts. Throws as usual_fine_contrast.
ScoreOptions with_usual_fine_contrast(const Ground& ground, const GroundImagery& imagery, ScoreOptions options,
                                      int threads = 0, const Progress& progress = {});

}  // namespace pilotage
