#include "pilotage/evaluate/evaluation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/statistics.h"
#include "pilotage/base/text.h"
#include "pilotage/evaluate/judge_tiles.h"
#include "pilotage/ground/place_level.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/matchability/fit_model.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

constexpr double kTolerancePx = 5;
constexpr double kLeastTolerance_m = 3;
constexpr double kNccTolerancePx = 1.5;

struct Predictor {
  const char* name;
  const char* title;
  bool probability;
};

constexpr Predictor kPredictors[] = {{"p_correct_fix", "P(correct fix)", true},
                                     {"gray_variance", "gray variance", false},
                                     {"frieden_deficit", "Frieden deficit", false},
                                     {"clean_peak_margin", "uniqueness, clean", false},
                                     {"degraded_peak_margin", "uniqueness, degraded copies", false}};

void check(const LevelScores& judged, const std::vector<FlightFrame>& frames, const EvaluateOptions& options) {
  check_evaluation(options);
  const bool any_truth = std::any_of(frames.begin(), frames.end(),
                                     [](const FlightFrame& frame) { return frame.frame.truth().has_value(); });
  if (!options.frames.empty() && !any_truth) {
    throw DataError(options.frames + ": no frame has its truth (true_lon_deg, true_lat_deg)");
  }
  if (judged.ground.tiles.empty()) throw DataError("there are no scored tiles to evaluate");
}

double tolerance_m(const EvaluateOptions& options, double gsd_m) {
  if (options.tolerance_m) return *options.tolerance_m;
  const bool ncc = options.matcher == EvaluateMatcher::kNcc;
  return ncc ? kNccTolerancePx * gsd_m : std::max(kTolerancePx * gsd_m, kLeastTolerance_m);
}

std::vector<TileOutcome> outcomes_of(const LevelScores& judged, const std::vector<FlightFrame>& frames,
                                     const EvaluateOptions& options, double within_m,
                                     const std::filesystem::path& scratch, std::uint64_t seed, int threads,
                                     const Progress& progress, const PlaceOnReference& place) {
  const std::vector<std::size_t> tiles = choose_tiles(judged, options.stride, options.max_tiles, seed);
  if (tiles.empty()) throw DataError("no tile has enough ground to be evaluated");
  if (options.matcher == EvaluateMatcher::kNcc) {
    return judge_by_ncc(judged, tiles, place, options, within_m, threads, progress);
  }
  const OutputFile map(scratch, true);  // never committed: goes with this scope
  build_evaluation_map(map.temporary_path(), judged, options.chips, threads, progress);
  if (!options.frames.empty()) {
    return judge_by_frames(judged, map.temporary_path(), frames, options, within_m, threads, progress);
  }
  return judge_by_voting(judged, tiles, map.temporary_path(), place, options, within_m, seed, threads, progress);
}

std::int64_t count_false_like_neighbours(const LevelScores& judged, const Evaluation& evaluation) {
  constexpr std::size_t kFewestNeighbours = 5;
  std::int64_t count = 0;
  for (const TileOutcome& outcome : evaluation.outcomes) {
    if (outcome.outcome != Outcome::kFalse) continue;
    const GroundTile& here = judged.ground.tiles[outcome.tile];
    std::vector<double> east_m;
    std::vector<double> north_m;
    for (const TileOutcome& other : evaluation.outcomes) {
      if (&other == &outcome || !is_accepted(other)) continue;
      const GroundTile& there = judged.ground.tiles[other.tile];
      const double distance_px =
          std::hypot(static_cast<double>((there.column - here.column) * judged.matrix().stride_px),
                     static_cast<double>((there.row - here.row) * judged.matrix().stride_px));
      if (distance_px >= judged.matrix().tile_size_px) continue;
      east_m.push_back(other.error_east_m);
      north_m.push_back(other.error_north_m);
    }
    if (east_m.size() < kFewestNeighbours) continue;
    const double apart_m =
        std::hypot(outcome.error_east_m - quantile(east_m, 0.5), outcome.error_north_m - quantile(north_m, 0.5));
    if (apart_m <= evaluation.tolerance_m) ++count;
  }
  return count;
}

// P at the level of this place, learned from its own outcomes: what P is worth where the level is known. Nothing where
// no tile depends on a level.
std::optional<JudgedPredictor> judge_inside(const LevelScores& judged, Evaluation& evaluation,
                                            const QualityOptions& options) {
  std::vector<JudgedPrediction> predictions = predictions_of(judged, evaluation, "p_correct_fix");
  std::vector<double> logits;
  std::vector<bool> correct;
  double sigma = 0;
  std::size_t at = 0;
  std::vector<std::size_t> with_level;
  for (const TileOutcome& outcome : evaluation.outcomes) {
    if (outcome.outcome == Outcome::kNotTried) continue;
    const TileScores& score = judged.scores[outcome.tile];
    const std::size_t index = at++;
    if (!(score.level_sigma > 0) || !(score.p_correct_fix > 0 && score.p_correct_fix < 1)) continue;
    sigma = score.level_sigma;
    with_level.push_back(index);
    logits.push_back(logit_of_p(score.p_correct_fix, score.level_sigma));
    correct.push_back(predictions[index].correct);
  }
  if (with_level.empty()) return std::nullopt;
  const LevelPosterior level = level_posterior({0, sigma}, logits, correct, 1 / kTilesThatShareGround);
  evaluation.level_z = level.mean / sigma;
  for (std::size_t i = 0; i < with_level.size(); ++i) {
    predictions[with_level[i]].value = p_over_level(logits[i] + level.mean, level.sigma);
  }
  return JudgedPredictor{"p_correct_fix_at_level", "P(correct fix), level of this place known",
                         judge_predictions(predictions, true, options)};
}

}  // namespace

void check_evaluation(const EvaluateOptions& options) {
  check_options(options);
  if (!options.wanted()) throw UsageError("there is nothing to evaluate by: give --evaluate or --evaluate-frames");
  if (!options.file.empty() && !options.frames.empty()) {
    throw UsageError("--evaluate and --evaluate-frames exclude each other");
  }
  if (!options.frames.empty() && options.matcher == EvaluateMatcher::kNcc) {
    throw UsageError("--evaluate-frames is for the matcher that flies: --evaluate-matcher ncc needs --evaluate");
  }
  if (!options.file.empty()) inspect_imagery(options.file);
}

QualityOptions quality_options(const EvaluateOptions& options, std::uint64_t seed, int threads) {
  QualityOptions quality;
  quality.bins = options.bins;
  quality.resamples = options.resamples;
  if (options.stated_rate) quality.stated_rate = *options.stated_rate;
  quality.seed = seed;
  quality.threads = threads;
  return quality;
}

std::int64_t Evaluation::judged() const {
  return std::count_if(outcomes.begin(), outcomes.end(),
                       [](const TileOutcome& outcome) { return outcome.outcome != Outcome::kNotTried; });
}

std::vector<std::string> predictor_columns() {
  std::vector<std::string> names;
  for (const Predictor& predictor : kPredictors) names.emplace_back(predictor.name);
  return names;
}

std::vector<const Measure*> columns_of_evaluation() {
  std::vector<std::string> names = predictor_columns();
  names.insert(names.end(), {"map_features", "vote_noise", "fine_contrast"});
  std::vector<const Measure*> columns;
  for (const std::string& name : names) columns.push_back(find_measure(name));
  return columns;
}

std::vector<JudgedPrediction> predictions_of(const LevelScores& judged, const Evaluation& evaluation,
                                             const std::string& name) {
  const Measure* measure = find_measure(name);
  if (measure == nullptr) throw UsageError("\"" + name + "\" is no column of tiles.csv");
  const double block_px = evaluation.block_m / evaluation.gsd_m;
  std::vector<JudgedPrediction> predictions;
  for (const TileOutcome& outcome : evaluation.outcomes) {
    if (outcome.outcome == Outcome::kNotTried) continue;
    predictions.push_back({measure->get(judged.scores[outcome.tile]), outcome.outcome == Outcome::kCorrect,
                           block_of(judged, judged.ground.tiles[outcome.tile], block_px)});
  }
  return predictions;
}

std::vector<JudgedPredictor> judge_predictors(const LevelScores& judged, const Evaluation& evaluation,
                                              const EvaluateOptions& options, std::uint64_t seed, int threads,
                                              const Progress& progress) {
  std::vector<JudgedPredictor> predictors;
  std::int64_t done = 0;
  for (const Predictor& predictor : kPredictors) {
    report_progress(progress, "judging scores", done++, std::ssize(kPredictors));
    JudgedPredictor next{predictor.name, predictor.title, {}};
    next.quality = judge_predictions(predictions_of(judged, evaluation, predictor.name), predictor.probability,
                                     quality_options(options, seed, threads));
    if (predictor.probability && next.quality.count == 0) continue;  // no model
    predictors.push_back(std::move(next));
  }
  return predictors;
}

Evaluation evaluate(const LevelScores& judged, const std::vector<FlightFrame>& frames, const EvaluateOptions& options,
                    const std::filesystem::path& scratch, std::uint64_t seed, int threads, const Progress& progress,
                    const PlaceOnReference& place) {
  check(judged, frames, options);
  Evaluation evaluation;
  evaluation.gsd_m = ground_gsd_m(judged);
  evaluation.footprint_m = judged.matrix().tile_size_px * evaluation.gsd_m;
  evaluation.search_radius_m = judged.level.search_radius_px * evaluation.gsd_m;
  evaluation.tolerance_m = tolerance_m(options, evaluation.gsd_m);
  evaluation.block_m = options.block_tiles * evaluation.footprint_m;
  evaluation.scored_tiles = static_cast<std::int64_t>(choose_tiles(judged, 1, 0, seed).size());
  evaluation.outcomes =
      outcomes_of(judged, frames, options, evaluation.tolerance_m, scratch, seed, threads, progress, place);
  for (const Outcome outcome : kOutcomes) evaluation.counts[outcome] = 0;
  for (const TileOutcome& outcome : evaluation.outcomes) ++evaluation.counts[outcome.outcome];
  if (evaluation.judged() == 0) {
    throw DataError((options.file.empty() ? options.frames : options.file) + ": shows none of the scored tiles");
  }
  if (evaluation.counts[Outcome::kNotTried] > 0) {
    evaluation.warnings.push_back(std::to_string(evaluation.counts[Outcome::kNotTried]) + " of " +
                                  std::to_string(evaluation.outcomes.size()) +
                                  (options.file.empty() ? " frames show no scored tile and are left out"
                                                        : " tiles are not covered by the other date and are left out"));
  }
  evaluation.false_like_neighbours = count_false_like_neighbours(judged, evaluation);
  evaluation.predictors = judge_predictors(judged, evaluation, options, seed, threads, progress);
  auto inside = judge_inside(judged, evaluation, quality_options(options, seed, threads));
  if (inside) evaluation.predictors.insert(evaluation.predictors.begin() + 1, std::move(*inside));
  return evaluation;
}

}  // namespace pilotage
