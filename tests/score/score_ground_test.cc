#include "pilotage/score/score_ground.h"

#include <algorithm>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "testing/float_ground.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/matchability/reasons.h"
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

/// A grid of which no more than a part stays in memory is scored part by part: each tile as it is alone.
TEST(ScoreGround, OfALargeGridIsScoredPartByPart) {
  const testing::TemporaryFolder folder;
  ScoreRunOptions options;
  options.grid.gsd_m = 0.03125;
  options.grid.tile_size_px = 64;
  options.grid.stride_px = 1000;
  options.grid.search_radius_px = 12;
  options.score.measures = {ScoreMeasure::kGrayVariance, ScoreMeasure::kUniqueness, ScoreMeasure::kGroundCover,
                            ScoreMeasure::kCorrectFix};
  const ScoreRun run = open_score_run({testing::write_float_ground(folder, 10, 12'000)}, options, 7);
  const Ground all = whole_ground(run);
  const TileMatrix& matrix = all.levels.front().matrix;
  ASSERT_GT(matrix.grid_width_px * matrix.grid_height_px * 9, kImageryBytes) << "9 bytes: a double and its mask";
  std::vector<std::string> order;
  std::map<std::string, std::int64_t> told;
  const auto scores = score_ground_tiles(all, run.options.score, nullptr, run.seed, 2,
                                         [&](std::string_view what, std::int64_t done, std::int64_t total) {
                                           const std::string name(what);
                                           if (order.empty() || order.back() != name) order.push_back(name);
                                           if (name == "ground cover") {
                                             EXPECT_EQ(total, matrix.tile_count());
                                           }
                                           if (total == matrix.tile_count()) {
                                             EXPECT_GE(done, told[name]) << name;
                                             told[name] = done;
                                           }
                                           return true;
                                         });
  EXPECT_EQ(std::count(order.begin(), order.end(), "ground cover"), 3) << "64 columns each";
  EXPECT_EQ(std::count(order.begin(), order.end(), "usual contrast"), 1);
  EXPECT_EQ(told["ground cover"], matrix.tile_count());
  const std::vector<TileRow> rows = tile_rows(all, scores);
  for (const std::int64_t place : {std::int64_t{0}, matrix.tile_count() - 1}) {
    const Ground one = part_of_ground(run, {place}, 1);
    const auto alone = tile_rows(one, score_ground_tiles(one, run.options.score, nullptr, run.seed, 1));
    EXPECT_EQ(tile_table_to_csv(alone), tile_table_to_csv(std::span(rows).subspan(static_cast<std::size_t>(place), 1)))
        << place;
  }
}

}  // namespace
}  // namespace pilotage
