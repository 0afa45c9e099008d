#include "pilotage/select/select_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "select/straight_plan.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using testing::good_scores;
using testing::straight_plan;

constexpr StoredSize kSize{.bytes_per_px = 0.5, .bytes_per_tile = 700, .bytes_fixed = 100000};

TEST(IsMatchable, JudgesDegradedCopiesBeforeTheCleanSurface) {
  SelectOptions options;
  TileScore score;
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

TEST(SelectTiles, TakesEveryMatchableTileByDefault) {
  const TilePlan plan = straight_plan(3000);
  auto scores = good_scores(plan);
  std::reverse(scores.begin(), scores.end());  // any order will do
  scores[5].degraded.margin = -0.2;
  const Selection selection = select_tiles(plan, scores, kSize, {});
  EXPECT_EQ(selection.tile_ids.size(), plan.tiles.size() - 1);
  EXPECT_TRUE(std::is_sorted(selection.tile_ids.begin(), selection.tile_ids.end()));
  EXPECT_FALSE(std::binary_search(selection.tile_ids.begin(), selection.tile_ids.end(), scores[5].tile_id));
}

TEST(SelectTiles, ATileWithoutScoreMakesAGap) {
  const TilePlan plan = straight_plan(3000);
  auto scores = good_scores(plan);
  for (std::size_t i = 0; i < scores.size(); ++i) {
    if (std::abs(plan.tiles[i].route_distance_m - 1500) < 200) scores[i].status = TileStatus::kFlat;
  }
  const Selection selection = select_tiles(plan, scores, kSize, {});
  ASSERT_EQ(selection.gaps.size(), 1U);
  EXPECT_NEAR(selection.gaps[0].from_distance_m, 1325, 20);
  EXPECT_NEAR(selection.gaps[0].to_distance_m, 1675, 20);
}

TEST(SelectTiles, SparseStoresFewTilesAndHoldsTheLimit) {
  const TilePlan plan = straight_plan(30000);
  SelectOptions options;
  const Selection all = select_tiles(plan, good_scores(plan), kSize, options);
  options.sparse = true;
  const Selection sparse = select_tiles(plan, good_scores(plan), kSize, options);
  EXPECT_TRUE(sparse.within_limit);
  EXPECT_FALSE(sparse.tile_ids.empty());
  EXPECT_LT(sparse.tile_ids.size(), all.tile_ids.size() / 4);
  EXPECT_LT(sparse.estimated_bytes, all.estimated_bytes);
  EXPECT_TRUE(std::includes(all.tile_ids.begin(), all.tile_ids.end(), sparse.tile_ids.begin(), sparse.tile_ids.end()));
}

TEST(SelectTiles, BudgetIsKeptAndSparseAreasSurviveIt) {
  const TilePlan plan = straight_plan(30000);
  const auto scores = good_scores(plan);
  SelectOptions sparse_options;
  sparse_options.sparse = true;
  const Selection sparse = select_tiles(plan, scores, kSize, sparse_options);
  const Selection all = select_tiles(plan, scores, kSize, {});
  const std::int64_t budget = (sparse.estimated_bytes + all.estimated_bytes) / 2;
  SelectOptions options;
  options.budget = std::to_string(budget);
  const Selection selection = select_tiles(plan, scores, kSize, options);
  EXPECT_LE(selection.estimated_bytes, budget);
  EXPECT_GT(selection.estimated_bytes, budget * 9 / 10);
  EXPECT_TRUE(selection.within_limit);
  EXPECT_TRUE(std::includes(selection.tile_ids.begin(), selection.tile_ids.end(), sparse.tile_ids.begin(),
                            sparse.tile_ids.end()));
}

TEST(SelectTiles, RefusesWhatDoesNotFit) {
  const TilePlan plan = straight_plan(3000);
  auto scores = good_scores(plan);
  SelectOptions options;
  options.budget = "50kB";  // an empty map has more
  EXPECT_THROW(select_tiles(plan, scores, kSize, options), UsageError);
  scores.pop_back();
  EXPECT_THROW(select_tiles(plan, scores, kSize, {}), DataError);
}

}  // namespace
}  // namespace pilotage
