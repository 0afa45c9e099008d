#include "pilotage/score/predict_correct_fixes.h"

#include "pilotage/matchability/matchability_model.h"
#include "pilotage/matchability/self_votes.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {

void predict_correct_fixes(const GraySource& source, const TileMatrix& matrix, const ScoreOptions& options,
                           std::vector<TileScore>& scores, int threads, const Progress& progress) {
  const MatchabilityModel model =
      options.model.empty() ? default_matchability_model() : read_matchability_model(options.model);
  model_of(model, options.matcher);  // refuses before the work is done
  std::vector<TileScore*> scored;
  std::vector<std::int64_t> indices;
  for (TileScore& score : scores) {
    if (score.status == TileStatus::kFlat) score.p_correct_fix = 0;
    if (score.status != TileStatus::kScored) continue;
    scored.push_back(&score);
    indices.push_back(score.row * matrix.matrix_width() + score.column);
  }
  // The map's features are found in 8 bits, and the contrast that they have is what counts.
  const double black = source.depth == CV_8U ? 0 : find_stretch(source).low;
  const auto votes = count_self_votes(stretch_to_8bit(source), matrix, indices, options.features, threads, progress);
  for (std::size_t i = 0; i < scored.size(); ++i) {
    scored[i]->map_features = static_cast<double>(votes[i].features);
    scored[i]->vote_noise = votes[i].noise;
    const MatchabilityInputs inputs = matchability_inputs(*scored[i], matrix.tile_size_px, black);
    scored[i]->p_correct_fix = predict_p_correct_fix(model, options.matcher, inputs, scored[i]->map_features);
  }
}

}  // namespace pilotage
