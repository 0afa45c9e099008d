#include "pilotage/score/score_ground.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/matchability/reasons.h"

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

}  // namespace
}  // namespace pilotage
