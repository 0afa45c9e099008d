#include "pilotage/select/leg_advice.h"

#include <cmath>

#include "select/straight_mission.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/select/select_tiles.h"

namespace pilotage {
namespace {

using testing::good_scores;
using ::testing::HasSubstr;
using testing::kStoredSize;
using testing::straight_mission;

// Eastward, three legs of 2 km; over the second, tiles within 60 m of the line are bad and further off P is `p_left`
// (north) and `p_right` (south).
struct ThreeLegs {
  Mission mission = straight_mission(6000, 150, 3);
  std::vector<TileScores> scores = good_scores(mission);
  SelectOptions options;

  ThreeLegs(double p_left, double p_right) {
    mission.flight.max_error_m = testing::error_after_s(mission, 40);
    for (std::size_t i = 0; i < scores.size(); ++i) {
      const Eigen::Vector2d center = mission.ground.tiles[i].bounds.center_m();
      scores[i].p_correct_fix = 0.95;
      if (center.x() < 1900 || center.x() > 4100) continue;
      scores[i].p_correct_fix = center.y() > 60 ? p_left : center.y() < -60 ? p_right : 0.1;
    }
    options.advise = true;
  }
};

TEST(LegAdvice, NamesTheNearestLineThatIsGood) {
  const ThreeLegs scene(0.2, 0.9);
  const Selection selection = select_tiles(scene.mission, scene.scores, kStoredSize, scene.options);
  EXPECT_GT(selection.legs[0].p_within_limit, 0.99);
  EXPECT_LT(selection.legs[1].p_within_limit, 0.01);
  ASSERT_GE(selection.advice.size(), 1U);
  const LegAdvice& advice = selection.advice[0];
  EXPECT_EQ(advice.leg, 1);
  EXPECT_EQ(advice.side, AdviceSide::kRight) << "south of an eastward leg";
  EXPECT_EQ(advice.offset_m, 100);
  EXPECT_EQ(advice.p_before, selection.legs[1].p_within_limit);
  EXPECT_GE(advice.p_after, 0.95);
  EXPECT_TRUE(advice.good);
  EXPECT_THAT(selection.notes, ::testing::Contains(HasSubstr("flown 100 m to the right it has ")));
}

TEST(LegAdvice, SaysWhereNothingIsGoodEnough) {
  ThreeLegs scene(0.55, 0.1);
  scene.options.min_leg_probability = 0.99999;
  const Selection selection = select_tiles(scene.mission, scene.scores, kStoredSize, scene.options);
  ASSERT_GE(selection.advice.size(), 1U);
  const LegAdvice& advice = selection.advice[0];
  EXPECT_EQ(advice.leg, 1);
  EXPECT_EQ(advice.side, AdviceSide::kLeft);
  EXPECT_FALSE(advice.good);
  EXPECT_GT(advice.p_after, advice.p_before);
  EXPECT_THAT(selection.notes, ::testing::Contains(HasSubstr("makes it good; the best: flown 150 m to the left")));
}

TEST(LegAdvice, SaysWhereNothingIsBetter) {
  const ThreeLegs scene(0.1, 0.1);
  const Selection selection = select_tiles(scene.mission, scene.scores, kStoredSize, scene.options);
  ASSERT_GE(selection.advice.size(), 1U);
  EXPECT_EQ(selection.advice[0].side, AdviceSide::kNone);
  EXPECT_EQ(selection.advice[0].p_after, selection.advice[0].p_before);
  EXPECT_THAT(selection.notes, ::testing::Contains(HasSubstr("no parallel line up to 150 m aside")));
}

// The advice is what the leg is worth when the route is really drawn there.
TEST(LegAdvice, TheLineThatIsNamedHoldsWhatItPromises) {
  const ThreeLegs scene(0.9, 0.1);
  const Selection selection = select_tiles(scene.mission, scene.scores, kStoredSize, scene.options);
  ASSERT_GE(selection.advice.size(), 1U);
  ASSERT_EQ(selection.advice[0].side, AdviceSide::kLeft);
  Mission moved = scene.mission;
  for (FlightSample& sample : moved.flight.samples) {
    if (sample.leg == 1) sample.point_map_m.y() += selection.advice[0].offset_m;
  }
  const Selection again = select_tiles(moved, scene.scores, kStoredSize, scene.options);
  EXPECT_NEAR(again.legs[1].p_within_limit, selection.advice[0].p_after, 1e-9);
}

// A small budget left the line's good tiles out: that is no reason to fly elsewhere.
TEST(LegAdvice, TriesTheLineItselfWithAllTilesFirst) {
  ThreeLegs scene(0.95, 0.95);
  for (TileScores& score : scene.scores) score.p_correct_fix = 0.95;
  scene.options.budget = "110kB";
  const Selection selection = select_tiles(scene.mission, scene.scores, kStoredSize, scene.options);
  ASSERT_FALSE(selection.advice.empty());
  EXPECT_EQ(selection.advice[0].side, AdviceSide::kNone);
  EXPECT_EQ(selection.advice[0].offset_m, 0);
  EXPECT_TRUE(selection.advice[0].good);
  EXPECT_THAT(selection.notes, ::testing::Contains(HasSubstr("with every tile stored that can be matched it has ")));
}

TEST(LegAdvice, NeedsProbabilities) {
  ThreeLegs scene(0.9, 0.9);
  for (TileScores& score : scene.scores) score.p_correct_fix = std::nan("");
  const Selection selection = select_tiles(scene.mission, scene.scores, kStoredSize, scene.options);
  EXPECT_FALSE(selection.probability);
  EXPECT_TRUE(selection.advice.empty());
  EXPECT_THAT(selection.notes, ::testing::Contains(HasSubstr("no leg can be advised on")));
}

}  // namespace
}  // namespace pilotage
