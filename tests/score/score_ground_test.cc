#include "pilotage/score/score_ground.h"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "testing/float_ground.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/matchability/reasons.h"
#include "pilotage/score/add_ground_cover.h"
#include "pilotage/score/score_run.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// A tile whose best rival is 10 px to the right of it.
TileScores repeating(double p) {
  TileScores score;
  score.valid_fraction = 1;
  score.p_correct_fix = p;
  score.clean.peak = 1;
  score.clean.rival_ratio = 0.95;
  score.clean.rival_dx_px = 10;
  score.clean.rival_dy_px = 0;
  score.relief_m = 30;
  return score;
}

/// Two levels, flown over from 60 m and from 600 m.
Ground two_levels() {
  Ground ground;
  ground.crs = Crs::from_user_input("EPSG:32633");
  for (int number = 0; number < 2; ++number) {
    GridLevel level;
    level.matrix = {number, GeoTransform::north_up(500000, 5000000, 1 + number), 1000, 1000, 400, 400};
    level.gsd_m = 1 + number;
    level.min_agl_m = number == 0 ? 60 : 6000;
    level.max_agl_m = 10 * level.min_agl_m;
    ground.levels.push_back(level);
    for (std::int64_t column = 0; column < 2; ++column) {
      GroundTile tile;
      tile.tile_id = tile_id_of(ground.levels, number, column, 0);
      tile.level = number;
      tile.column = column;
      ground.tiles.push_back(tile);
    }
  }
  return ground;
}

TEST(ExplainScores, HoldsEachTileAgainstItsOwnLevel) {
  const Ground ground = two_levels();
  std::vector<TileScores> scores{repeating(0.3), repeating(0.95), repeating(0.3), repeating(0.95)};
  scores[1].reasons = scores[3].reasons = {ReasonCode::kWater};  // of an earlier look
  explain_scores(ground, scores);
  for (const std::size_t i : {0U, 2U}) {
    const ReasonContext context = reason_context(ground.crs, ground.levels[i / 2]);
    EXPECT_EQ(scores[i].reasons, reason_codes(scores[i], context));
  }
  EXPECT_THAT(scores[0].reasons, ::testing::Contains(ReasonCode::kRelief)) << "30 m of relief seen from 60 m";
  EXPECT_THAT(scores[2].reasons, ElementsAre(ReasonCode::kRepeats)) << "and from 6000 m";
  EXPECT_THAT(scores[1].reasons, IsEmpty());
  EXPECT_THAT(scores[3].reasons, IsEmpty());
}

/// Tiles around the corner where four parts of a grid meet that does not stay in memory, as they are when all measures
/// go over all of them.
TEST(ScoreGround, OfALargeGridIsScoredPartByPart) {
  const testing::TemporaryFolder folder;
  ScoreRunOptions options;
  options.grid.gsd_m = 0.0625;
  options.grid.tile_size_px = 64;
  options.grid.stride_px = 100;
  options.grid.search_radius_px = 12;
  options.score.measures = {ScoreMeasure::kGrayVariance, ScoreMeasure::kUniqueness, ScoreMeasure::kDegraded,
                            ScoreMeasure::kGroundCover, ScoreMeasure::kCorrectFix};
  options.score.degraded_copies = 1;
  const ScoreRun run = open_score_run({testing::write_float_ground(folder, 500, 1000)}, options, 7);
  const TileMatrix& matrix = run.ground.levels.front().matrix;
  std::vector<std::int64_t> indices;
  for (std::int64_t row = 8; row < 36; ++row) {
    for (std::int64_t column = 61; column < 66; ++column) indices.push_back(matrix.index_of(column, row));
  }
  Ground ground = run.ground;
  cut_tiles(ground, indices);
  const GroundImagery imagery = open_imagery(ground);
  ASSERT_LT(imagery.levels.front().kept_px, matrix.grid_width_px * matrix.grid_height_px);

  std::vector<std::string> order;
  std::int64_t told = 0;
  const auto scores = score_ground_tiles(
      ground, run.options.score, nullptr, run.seed, 2,
      [&](std::string_view what, std::int64_t done, std::int64_t total) {
        if (order.empty() || order.back() != what) order.emplace_back(what);
        if (what == "usual contrast" || total == 0) return true;
        EXPECT_EQ(total, std::ssize(indices)) << what;
        EXPECT_GE(done, told) << what;
        told = done;
        return true;
      },
      &imagery);
  EXPECT_EQ(told, std::ssize(indices));
  EXPECT_EQ(std::count(order.begin(), order.end(), "usual contrast"), 1);
  EXPECT_GE(std::count(order.begin(), order.end(), "ground cover"), 4);

  const GrayAndColors& level = imagery.levels.front();
  std::vector<TileScores> at_once =
      score_tiles(level.gray, matrix, ground.levels.front().search_radius_px, indices, run.options.score, run.seed, 1);
  std::optional<double> white;
  add_ground_cover(level.colors, white, matrix, indices, at_once, 1, {});
  EXPECT_EQ(tile_table_to_csv(ground, scores), tile_table_to_csv(ground, at_once));
}

}  // namespace
}  // namespace pilotage
