#include "pilotage/evaluate/evaluation.h"

#include "evaluate/scored_dates.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using testing::scored_dates;

EvaluateOptions by(const std::string& other, EvaluateMatcher matcher = EvaluateMatcher::kVoting) {
  EvaluateOptions options;
  options.file = other;
  options.matcher = matcher;
  options.resamples = 50;
  return options;
}

Evaluation run(const EvaluateOptions& options, int threads = 2) {
  const testing::TemporaryFolder work;
  const Evaluation evaluation = evaluate(scored_dates().judged(), {}, options, work / "scratch.gpkg", 1, threads, {});
  EXPECT_TRUE(std::filesystem::is_empty(work.path())) << "the temporary map stays";
  return evaluation;
}

TEST(Evaluation, CountsOutcomesAndJudgesEveryMeasure) {
  const Evaluation evaluation = run(by(scored_dates().other));
  EXPECT_EQ(evaluation.outcomes.size(), 81U);
  EXPECT_EQ(evaluation.scored_tiles, 81);
  std::int64_t sum = 0;
  for (const auto& [outcome, count] : evaluation.counts) sum += count;
  EXPECT_EQ(sum, 81);
  EXPECT_NEAR(evaluation.footprint_m, 48, 0.1);
  EXPECT_NEAR(evaluation.search_radius_m, 20, 0.1);
  EXPECT_EQ(evaluation.tolerance_m, 3);
  EXPECT_NEAR(evaluation.block_m, 4 * evaluation.footprint_m, 1e-9);
  ASSERT_EQ(evaluation.predictors.size(), 5U);
  EXPECT_EQ(evaluation.predictors[0].name, "p_correct_fix");
  EXPECT_TRUE(evaluation.predictors[0].quality.probability);
  EXPECT_EQ(evaluation.predictors[0].quality.count, evaluation.judged());
  EXPECT_EQ(evaluation.predictors[0].quality.correct, evaluation.counts.at(Outcome::kCorrect));
  EXPECT_EQ(evaluation.predictors[1].name, "gray_variance");
  // P is the variance cut at 1 here, so both rank alike but for ties.
  EXPECT_NEAR(evaluation.predictors[1].quality.auc.value, evaluation.predictors[0].quality.auc.value, 0.1);
  EXPECT_EQ(evaluation.predictors[4].name, "degraded_peak_margin");
  EXPECT_EQ(evaluation.predictors[4].quality.count, 0) << "not measured";
  EXPECT_EQ(evaluation.predictors[4].quality.undefined, evaluation.judged());
}

TEST(Evaluation, WithoutAModelThereIsNoRowForIt) {
  std::vector<TileScores> scores = scored_dates().scores;
  for (TileScores& score : scores) score.p_correct_fix = std::numeric_limits<double>::quiet_NaN();
  const LevelScores judged(ScoreTable(scored_dates().ground, scores), 0);
  const testing::TemporaryFolder work;
  const Evaluation evaluation =
      evaluate(judged, {}, by(scored_dates().other, EvaluateMatcher::kNcc), work / "scratch.gpkg", 1, 2, {});
  ASSERT_EQ(evaluation.predictors.size(), 4U);
  EXPECT_EQ(evaluation.predictors[0].name, "gray_variance");
}

TEST(Evaluation, SaysWhenFalseFixesAgreeWithEachOther) {
  const Evaluation right = run(by(scored_dates().other));
  const Evaluation moved = run(by(scored_dates().moved));
  EXPECT_LE(right.false_like_neighbours, 1);
  EXPECT_GE(moved.false_like_neighbours, 6);
  EXPECT_LE(moved.false_like_neighbours, moved.counts.at(Outcome::kFalse));
}

TEST(Evaluation, TilesThatTheOtherDateDoesNotShowAreLeftOut) {
  EvaluateOptions options = by(scored_dates().moved, EvaluateMatcher::kNcc);
  const Evaluation evaluation = run(options);
  // 7 m of 48 m at the western border: less than nine tenths of the first column's tiles.
  EXPECT_EQ(evaluation.counts.at(Outcome::kNotTried), 9);
  EXPECT_EQ(evaluation.judged(), 72);
  ASSERT_EQ(evaluation.warnings.size(), 1U);
  EXPECT_NE(evaluation.warnings[0].find("9 of 81 tiles"), std::string::npos);
}

TEST(Evaluation, ToleranceFollowsTheMatcherUnlessGiven) {
  EvaluateOptions options = by(scored_dates().other, EvaluateMatcher::kNcc);
  options.max_tiles = 5;
  EXPECT_NEAR(run(options).tolerance_m, 0.75, 0.01);
  options.tolerance_m = 2;
  EXPECT_EQ(run(options).tolerance_m, 2);
  EXPECT_EQ(run(options).outcomes.size(), 5U);
}

TEST(Evaluation, RefusesOptionsAtOddsWithEachOther) {
  EXPECT_THROW(run({}), UsageError);
  EvaluateOptions both = by(scored_dates().other);
  both.frames = "frames.csv";
  EXPECT_THROW(run(both), UsageError);
  both.file.clear();
  EXPECT_THROW(run(both), DataError) << "frames without truth";
  both.matcher = EvaluateMatcher::kNcc;
  EXPECT_THROW(run(both), UsageError);
  EXPECT_THROW(predictions_of(scored_dates().judged(), {}, "no_such_column"), UsageError);
}

}  // namespace
}  // namespace pilotage
