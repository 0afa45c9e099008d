#include "pilotage/score/predict_correct_fixes.h"

#include <optional>
#include <utility>

#include "pilotage/base/nan.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/matchability/fine_contrast.h"
#include "pilotage/matchability/level_at_age.h"
#include "pilotage/matchability/matchability_model.h"
#include "pilotage/matchability/self_votes.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {

namespace {

/// The age that P counts. A model of one's own rests on dates that differ as one's map and flights do.
std::optional<double> counted_age_months(const ScoreOptions& options) {
  return options.model.empty() ? options.imagery_months : std::nullopt;
}

}  // namespace

MatchabilityModel model_for(const ScoreOptions& options) {
  MatchabilityModel model =
      options.model.empty() ? default_matchability_model() : read_matchability_model(options.model);
  model_of(model, options.matcher);
  if (const auto age_months = counted_age_months(options)) model = model_at_age(std::move(model), *age_months);
  return model;
}

void predict_correct_fixes(const GraySource& shown, const TileMatrix& matrix, const ScoreOptions& options,
                           const MatchabilityModel& model, std::span<const std::int64_t> tile_indices,
                           std::vector<TileScores>& scores, double usual_contrast, int threads,
                           const Progress& progress) {
  std::vector<TileScores*> scored;
  std::vector<std::int64_t> indices;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    TileScores& score = scores[i];
    if (score.status == TileStatus::kFlat) score.p_correct_fix = 0;
    if (score.status != TileStatus::kScored) continue;
    scored.push_back(&score);
    indices.push_back(tile_indices[i]);
  }
  const std::vector<double> contrasts = measure_fine_contrast(shown, matrix, indices, threads, progress);
  const auto votes = count_self_votes(shown, matrix, indices, options.features, threads, progress);
  for (std::size_t i = 0; i < scored.size(); ++i) {
    scored[i]->map_features = static_cast<double>(votes[i].features);
    scored[i]->vote_noise = votes[i].noise;
    scored[i]->fine_contrast = contrasts[i] / usual_contrast;
    const MatchabilityInputs inputs = matchability_inputs(*scored[i]);
    const FixPrediction fix = predict_correct_fix(model, options.matcher, inputs, scored[i]->map_features);
    scored[i]->p_correct_fix = fix.p;
    scored[i]->level_sigma = fix.level_sigma;
    scored[i]->level_tiles = static_cast<double>(fix.level_tiles);
    scored[i]->level_age_months = counted_age_months(options).value_or(kNaN);
  }
}

ScoreOptions with_usual_fine_contrast(const Ground& ground, const GroundImagery& imagery, ScoreOptions options,
                                      int threads, const Progress& progress) {
  constexpr double kLeast = 0.01;  // that the option takes
  if (options.usual_fine_contrast || !options.measure(ScoreMeasure::kCorrectFix)) return options;
  const GraySource shown = stretch_to_8bit(imagery.levels.front().gray);
  const double usual = usual_fine_contrast(shown, ground.levels.front().matrix.tile_size_px, threads, progress);
  if (usual >= kLeast) options.usual_fine_contrast = usual;
  return options;
}

}  // namespace pilotage
