#include "pilotage/score/predict_correct_fixes.h"

#include <algorithm>
#include <cmath>

#include "pilotage/matchability/matchability_model.h"
#include "pilotage/matchability/self_votes.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/score/usual_contrast.h"

namespace pilotage {
namespace {

/// σ/f̄ of a tile in the 8 bits that features are found in, where `black` of the imagery is 0.
double contrast_shown(const TileScores& score, double black) {
  const double contrast = std::sqrt(std::max(score.frieden_deficit, 0.0));
  if (black == 0 || !(contrast > 0)) return contrast;
  const double mean = score.gray_variance / contrast;
  return score.gray_variance / std::max(mean - black, 1e-9 * std::abs(mean));
}

}  // namespace

MatchabilityModel model_for(const ScoreOptions& options) {
  MatchabilityModel model =
      options.model.empty() ? default_matchability_model() : read_matchability_model(options.model);
  model_of(model, options.matcher);
  return model;
}

void predict_correct_fixes(const GraySource& source, const TileMatrix& matrix, const ScoreOptions& options,
                           const MatchabilityModel& model, std::span<const std::int64_t> tile_indices,
                           std::vector<TileScores>& scores, int threads, const Progress& progress) {
  std::vector<TileScores*> scored;
  std::vector<std::int64_t> indices;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    TileScores& score = scores[i];
    if (score.status == TileStatus::kFlat) score.p_correct_fix = 0;
    if (score.status != TileStatus::kScored) continue;
    scored.push_back(&score);
    indices.push_back(tile_indices[i]);
  }
  // The map's features are found in 8 bits, and the contrast that they have is what counts.
  const bool is_8bit = source.depth == CV_8U;
  const GrayStretch stretch = is_8bit ? GrayStretch{0, 255} : find_stretch(source);
  const GraySource shown = is_8bit ? source : stretch_to_8bit(source, stretch);
  const double usual = scored.empty() ? 0 : usual_contrast(shown, matrix.tile_size_px);
  const auto votes = count_self_votes(shown, matrix, indices, options.features, threads, progress);
  for (std::size_t i = 0; i < scored.size(); ++i) {
    scored[i]->map_features = static_cast<double>(votes[i].features);
    scored[i]->vote_noise = votes[i].noise;
    scored[i]->relative_contrast = contrast_shown(*scored[i], stretch.low) / usual;
    const MatchabilityInputs inputs = matchability_inputs(*scored[i]);
    const FixPrediction fix = predict_correct_fix(model, options.matcher, inputs, scored[i]->map_features);
    scored[i]->p_correct_fix = fix.p;
    scored[i]->level_sigma = fix.level_sigma;
    scored[i]->level_tiles = static_cast<double>(fix.level_tiles);
  }
}

}  // namespace pilotage
