#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/evaluate/evaluate_options.h"
#include "pilotage/evaluate/evaluated_tiles.h"
#include "pilotage/evaluate/tile_outcome.h"
#include "pilotage/flightlog/flight_frames.h"
#include "pilotage/ground/measures.h"
#include "pilotage/matchability/quality_report.h"

namespace pilotage {

/// Scores held against outcomes.
struct Evaluation {
  double gsd_m = 0;
  double footprint_m = 0;
  double search_radius_m = 0;
  double tolerance_m = 0;
  double block_m = 0;
  std::int64_t scored_tiles = 0;  ///< Tiles with enough ground.
  std::vector<TileOutcome> outcomes;
  std::map<Outcome, std::int64_t> counts;
  /// False ones whose error is, within the tolerance, the median error of the accepted ones around them (at least five
  /// others whose tiles' centres are nearer than a tile's side): a truth that is wrong, or ground that repeats.
  std::int64_t false_like_neighbours = 0;
  /// Where the level of this place lies, in standard deviations from the mean that P takes it to have; NaN where P does
  /// not depend on a level. Its prior is that of P, four tiles count as one (level_posterior).
  double level_z = std::numeric_limits<double>::quiet_NaN();
  /// p_correct_fix where any tile has one, across places; with it, where P depends on a level, P at the level that this
  /// place turns out to have (p_correct_fix_at_level): inside the place. Then always gray_variance, frieden_deficit,
  /// clean_peak_margin and degraded_peak_margin, the measures of the paper.
  std::vector<JudgedPredictor> predictors;
  std::vector<std::string> warnings;

  std::int64_t judged() const;  ///< Outcomes but those not covered.
};

/// How predictors are judged.
QualityOptions quality_options(const EvaluateOptions& options, std::uint64_t seed, int threads = 0);

/// The columns of tiles.csv that are judged: p_correct_fix and the measures of the paper.
std::vector<std::string> predictor_columns();

/// The measures that stand in evaluation.csv: what is judged, and what P is made of.
std::vector<const Measure*> columns_of_evaluation();

/// A prediction of column `name` of tiles.csv for each outcome that is covered, in their order.
std::vector<JudgedPrediction> predictions_of(const LevelScores& judged, const Evaluation& evaluation,
                                             const std::string& name);

/// Throws what evaluate() would for the options alone, before hours of scoring: UsageError unless exactly one of
/// options.file and options.frames is given and the matcher fits it, DataError when the imagery cannot be opened.
void check_evaluation(const EvaluateOptions& options);

/// Judges the scores of `ground` by options.file, or by `frames` (complete, with truth) where options.frames is given.
/// `scratch` is a path beside which a temporary map may grow; nothing stays there. The same for any number of threads.
/// Throws as check_evaluation; DataError when no frame has its truth or no tile is left to judge; otherwise as what it
/// calls.
Evaluation evaluate(const LevelScores& judged, const std::vector<FlightFrame>& frames, const EvaluateOptions& options,
                    const std::filesystem::path& scratch, std::uint64_t seed, int threads, const Progress& progress,
                    const PlaceOnReference& place = same_place);

/// The predictors alone, from outcomes and ground.
std::vector<JudgedPredictor> judge_predictors(const LevelScores& judged, const Evaluation& evaluation,
                                              const EvaluateOptions& options, std::uint64_t seed, int threads);

}  // namespace pilotage
