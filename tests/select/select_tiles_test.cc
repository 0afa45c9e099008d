#include "pilotage/select/select_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "select/straight_mission.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using testing::good_scores;
using testing::kStoredSize;
using testing::straight_mission;

TEST(IsMatchable, JudgesDegradedCopiesBeforeTheCleanSurface) {
  SelectOptions options;
  TileScores score;
  score.valid_fraction = 1;
  EXPECT_TRUE(is_matchable(score, options)) << "nothing measured: the status decides";
  score.clean.margin = 0.9;
  score.degraded.margin = 0.01;
  EXPECT_FALSE(is_matchable(score, options));
  score.degraded.margin = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(is_matchable(score, options));
  score.status = TileStatus::kTooLittleGround;
  EXPECT_FALSE(is_matchable(score, options));
  score.status = TileStatus::kFlat;
  EXPECT_FALSE(is_matchable(score, options));
}

TEST(IsMatchable, AProbabilityDecidesBeforeTheMargin) {
  SelectOptions options;
  TileScores score;
  score.degraded.margin = 0.9;
  score.p_correct_fix = 0.19;
  EXPECT_FALSE(is_matchable(score, options));
  options.min_p_correct_fix = 0.1;
  EXPECT_TRUE(is_matchable(score, options));
  score.degraded.margin = -0.9;
  EXPECT_TRUE(is_matchable(score, options));
  score.status = TileStatus::kTooLittleGround;
  EXPECT_FALSE(is_matchable(score, options));
}

TEST(SelectTiles, WithoutAnyMeasureOfMatchabilityNothingIsJudged) {
  const Mission mission = straight_mission(1000);
  std::vector<TileScores> scores = good_scores(mission);
  EXPECT_TRUE(select_tiles(mission, scores, kStoredSize, {}).matchability_judged);
  for (TileScores& score : scores)
    score.degraded.margin = score.clean.margin = std::numeric_limits<double>::quiet_NaN();
  const Selection selection = select_tiles(mission, scores, kStoredSize, {});
  EXPECT_FALSE(selection.tile_ids.empty());
  EXPECT_TRUE(selection.within_limit);
  EXPECT_FALSE(selection.matchability_judged);
  EXPECT_FALSE(meets_gate(selection));
  EXPECT_THAT(selection.notes.back(), ::testing::HasSubstr("not judged"));
}

TEST(SelectTiles, WithoutProbabilitiesThereAreNone) {
  const Mission mission = straight_mission(3000);
  const Selection selection = select_tiles(mission, good_scores(mission), kStoredSize, {});
  EXPECT_FALSE(selection.probability);
  EXPECT_TRUE(std::isnan(selection.legs[0].p_within_limit));
  EXPECT_TRUE(std::isnan(selection.error_profile[0].p_within_limit));
  EXPECT_TRUE(meets_gate(selection));
}

TEST(SelectTiles, ProbabilitiesOfTheFlight) {
  const Mission mission = straight_mission(6000, 50, 2);
  auto scores = good_scores(mission);
  for (TileScores& score : scores) score.p_correct_fix = 0.8;
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (mission.flight.places[i].distance_m > 3500 && mission.flight.places[i].distance_m < 4350)
      scores[i].p_correct_fix = 0.1;
  }
  scores[0].p_correct_fix = std::numeric_limits<double>::quiet_NaN();
  SelectOptions options;
  options.min_route_probability = 0.999999;
  const Selection selection = select_tiles(mission, scores, kStoredSize, options);
  ASSERT_TRUE(selection.probability);
  const double p = selection.probability->p_within_limit;
  EXPECT_GT(p, 0);
  EXPECT_LT(p, 0.999999);
  EXPECT_EQ(p, selection.error_profile.back().p_within_limit);
  EXPECT_NEAR(selection.legs[0].p_within_limit * selection.legs[1].p_within_limit, p, 1e-12);
  EXPECT_GT(selection.legs[0].p_fix, 0.99);
  EXPECT_FALSE(meets_gate(selection));
  ASSERT_EQ(selection.gaps.size(), 1U);
  EXPECT_GT(selection.gaps[0].p_first_excess, 0.1 * (1 - p)) << "the rest is lost behind it";
  EXPECT_LE(selection.gaps[0].p_first_excess, 1 - p + 1e-12);
  ASSERT_TRUE(selection.probability->worst);
  EXPECT_EQ(selection.probability->worst->leg, 1);
  EXPECT_EQ(selection.error_profile[380].p_correct_fix, 0) << "no tile is stored there";
  EXPECT_EQ(selection.error_profile[100].p_correct_fix, 0.8);
  // 258 s over stored ground, one try every 2 s.
  EXPECT_NEAR(selection.probability->expected_fixes, 0.8 * 258 / 2, 3);
  EXPECT_NEAR(selection.probability->expected_false_fixes, 0.001 * 0.2 * 258 / 2, 0.002);
  EXPECT_EQ(selection.notes.size(), 2U) << "one tile has no probability";
}

TEST(SelectTiles, SaysHowItTries) {
  const Mission mission = straight_mission(500);
  SelectOptions options;
  options.fix_interval_s = 1.5;
  EXPECT_FALSE(select_tiles(mission, good_scores(mission), kStoredSize, options).tries.value().decorrelation_m);
  options.fix_decorrelation_m = 80;
  const FixTries tries = select_tiles(mission, good_scores(mission), kStoredSize, options).tries.value();
  EXPECT_EQ(tries.interval_s, 1.5);
  EXPECT_EQ(tries.decorrelation_m, 80);
}

TEST(SelectTiles, TakesEveryMatchableTileByDefault) {
  const Mission mission = straight_mission(3000);
  auto scores = good_scores(mission);
  std::reverse(scores.begin(), scores.end());  // any order will do
  scores[5].degraded.margin = -0.2;
  const Selection selection = select_tiles(mission, scores, kStoredSize, {});
  EXPECT_EQ(selection.tile_ids.size(), mission.ground.tiles.size() - 1);
  EXPECT_TRUE(std::is_sorted(selection.tile_ids.begin(), selection.tile_ids.end()));
  EXPECT_FALSE(
      std::binary_search(selection.tile_ids.begin(), selection.tile_ids.end(), mission.ground.tiles[5].tile_id));
}

TEST(SelectTiles, ATileWithoutScoreMakesAGap) {
  const Mission mission = straight_mission(3000);
  auto scores = good_scores(mission);
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (std::abs(mission.flight.places[i].distance_m - 1500) < 200) scores[i].status = TileStatus::kFlat;
  }
  const Selection selection = select_tiles(mission, scores, kStoredSize, {});
  ASSERT_EQ(selection.gaps.size(), 1U);
  EXPECT_NEAR(selection.gaps[0].from_distance_m, 1325, 20);
  EXPECT_NEAR(selection.gaps[0].to_distance_m, 1675, 20);
}

TEST(SelectTiles, SparseStoresFewTilesAndHoldsTheLimit) {
  const Mission mission = straight_mission(30000);
  SelectOptions options;
  const Selection all = select_tiles(mission, good_scores(mission), kStoredSize, options);
  options.sparse = true;
  const Selection sparse = select_tiles(mission, good_scores(mission), kStoredSize, options);
  EXPECT_TRUE(sparse.within_limit);
  EXPECT_FALSE(sparse.tile_ids.empty());
  EXPECT_LT(sparse.tile_ids.size(), all.tile_ids.size() / 4);
  EXPECT_LT(sparse.estimated_bytes, all.estimated_bytes);
  EXPECT_TRUE(std::includes(all.tile_ids.begin(), all.tile_ids.end(), sparse.tile_ids.begin(), sparse.tile_ids.end()));
}

TEST(SelectTiles, BudgetIsKeptAndSparseAreasSurviveIt) {
  const Mission mission = straight_mission(30000);
  const auto scores = good_scores(mission);
  SelectOptions sparse_options;
  sparse_options.sparse = true;
  const Selection sparse = select_tiles(mission, scores, kStoredSize, sparse_options);
  const Selection all = select_tiles(mission, scores, kStoredSize, {});
  const std::int64_t budget = (sparse.estimated_bytes + all.estimated_bytes) / 2;
  SelectOptions options;
  options.budget = std::to_string(budget);
  const Selection selection = select_tiles(mission, scores, kStoredSize, options);
  EXPECT_LE(selection.estimated_bytes, budget);
  EXPECT_GT(selection.estimated_bytes, budget * 9 / 10);
  // What did not fit is named: with it the selection is that of no budget.
  ASSERT_TRUE(selection.left_out && all.left_out);
  EXPECT_TRUE(all.left_out->beyond_budget.empty());
  std::vector<std::int64_t> both = selection.tile_ids;
  both.insert(both.end(), selection.left_out->beyond_budget.begin(), selection.left_out->beyond_budget.end());
  std::sort(both.begin(), both.end());
  EXPECT_EQ(both, all.tile_ids);
  EXPECT_TRUE(selection.within_limit);
  EXPECT_TRUE(std::includes(selection.tile_ids.begin(), selection.tile_ids.end(), sparse.tile_ids.begin(),
                            sparse.tile_ids.end()));
}

TEST(SelectTiles, RefusesWhatDoesNotFit) {
  const Mission mission = straight_mission(3000);
  auto scores = good_scores(mission);
  SelectOptions options;
  options.budget = "50kB";  // an empty map has more
  EXPECT_THROW(select_tiles(mission, scores, kStoredSize, options), UsageError);
  scores.pop_back();
  EXPECT_THROW(select_tiles(mission, scores, kStoredSize, {}), DataError);
}

}  // namespace
}  // namespace pilotage
