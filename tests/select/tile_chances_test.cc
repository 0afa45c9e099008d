#include "pilotage/ground/tile_chances.h"

#include <cmath>
#include <limits>

#include "straight_mission.h"
#include <gtest/gtest.h>

#include "pilotage/ground/place_level.h"
#include "pilotage/select/fix_attempts.h"
#include "pilotage/select/route_probability.h"
#include "pilotage/select/select_tiles.h"

namespace pilotage {
namespace {

std::vector<TileScores> scores_with(const Mission& mission, double p, double level_sigma) {
  std::vector<TileScores> scores = testing::good_scores(mission);
  for (TileScores& score : scores) {
    score.p_correct_fix = p;
    score.level_sigma = level_sigma;
    score.level_tiles = 0;
  }
  return scores;
}

Selection selected(const Mission& mission, double p, double level_sigma) {
  return select_tiles(mission, scores_with(mission, p, level_sigma), testing::kStoredSize, {});
}

TEST(TileChances, TheMeanOverTheLevelsIsP) {
  std::vector<TileScores> scores(4);
  for (std::size_t i = 0; i < 4; ++i) scores[i].level_sigma = 2;
  scores[0].p_correct_fix = 0.7;
  scores[1].p_correct_fix = 0.05;
  scores[2].p_correct_fix = 0.999;
  const TileChances chances = tile_chances(scores, {true, true, true, true});
  ASSERT_EQ(chances.levels.size(), level_nodes().size());
  for (std::size_t i = 0; i < 4; ++i) {
    double mean = 0;
    for (const TileChances::AtLevel& level : chances.levels) mean += level.weight * level.p[i];
    EXPECT_NEAR(mean, i == 3 ? 1.0 : scores[i].p_correct_fix, 1e-9);
    EXPECT_NEAR(chances.p[i], mean, 1e-9);
  }
  EXPECT_LT(chances.levels.front().p[0], chances.levels.back().p[0]);
  EXPECT_EQ(of_chosen(chances, {true, false, true, true}).levels[3].p[1], 0);
}

TEST(TileChances, WithoutASpreadThereIsOneLevel) {
  std::vector<TileScores> scores(2);
  scores[0].p_correct_fix = 0.7;
  scores[1].p_correct_fix = 0.3;
  scores[1].level_sigma = 0;
  const TileChances chances = tile_chances(scores, {true, false});
  ASSERT_EQ(chances.levels.size(), 1u);
  EXPECT_EQ(chances.levels[0].weight, 1);
  EXPECT_EQ(chances.levels[0].p, (std::vector<double>{0.7, 0}));
}

TEST(RouteOverLevels, WithoutASpreadItIsTheRouteOfTheTilesAlone) {
  const Mission mission = testing::straight_mission(6000, 50, 2);
  const Selection known = selected(mission, 0.3, 0);
  const Selection none = selected(mission, 0.3, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(known.probability->p_within_limit, none.probability->p_within_limit);
  EXPECT_FALSE(known.probability->interval);
  for (std::size_t i = 0; i < known.error_profile.size(); ++i) {
    EXPECT_EQ(known.error_profile[i].p_within_limit, none.error_profile[i].p_within_limit);
  }
}

TEST(RouteOverLevels, IsTheMeanOfTheFlightsAtEachLevel) {
  Mission mission = testing::straight_mission(6000, 50, 2);
  const double sigma = 1.5;
  const Selection selection = selected(mission, 0.3, sigma);
  const double logit = logit_of_p(0.3, sigma);
  double mean = 0;
  std::vector<double> of_level;
  for (const LevelNode& node : level_nodes()) {
    SelectOptions all;
    all.min_p_correct_fix = 0;
    const std::vector<TileScores> scores = scores_with(mission, logistic(logit + sigma * node.z), 0);
    of_level.push_back(select_tiles(mission, scores, testing::kStoredSize, all).probability->p_within_limit);
    mean += node.weight * of_level.back();
  }
  EXPECT_NEAR(selection.probability->p_within_limit, mean, 1e-9);
  EXPECT_NEAR(selection.probability->interval->low, of_level[kLevelLow], 1e-9);
  EXPECT_NEAR(selection.probability->interval->high, of_level[kLevelHigh], 1e-9);
  double product = 1;
  for (const LegStatus& leg : selection.legs) product *= leg.p_within_limit;
  EXPECT_NEAR(product, selection.probability->p_within_limit, 1e-9) << "the route's is the product of its legs'";
}

TEST(RouteOverLevels, ASharedLevelHoldsAChainOfTriesBack) {
  const Mission mission = testing::straight_mission(6000, 50);
  double before = 2;
  double before_width = -1;
  for (const double sigma : {0.0, 0.5, 1.0, 2.0}) {
    const RouteProbability route = *selected(mission, 0.6, sigma).probability;
    EXPECT_LT(route.p_within_limit, before) << sigma;
    before = route.p_within_limit;
    if (!route.interval) continue;
    EXPECT_LE(route.interval->low, route.interval->high);
    EXPECT_GE(route.interval->high, route.p_within_limit);
    EXPECT_GT(route.interval->high - route.interval->low, before_width) << sigma;
    before_width = route.interval->high - route.interval->low;
  }
}

TEST(RouteOverLevelsThorough, AFixMoreLikelyNeverHurts) {
  const Mission mission = testing::straight_mission(4000, 50);
  double before = 0;
  for (double p = 0.2; p < 0.96; p += 0.05) {
    const double route = selected(mission, p, 1.5).probability->p_within_limit;
    EXPECT_GT(route, before - 0.002) << p;
    before = route;
  }
}

TEST(RouteOverLevels, SaysWhatItRestsOn) {
  const Mission mission = testing::straight_mission(1000);
  std::vector<TileScores> scores = scores_with(mission, 0.9, 1);
  const auto rests_on = [&] {
    return rests_on_text(*select_tiles(mission, scores, testing::kStoredSize, {}).probability);
  };
  EXPECT_NE(rests_on().find("one date of this ground"), std::string::npos);
  for (TileScores& score : scores) score.level_tiles = 150;
  EXPECT_NE(rests_on().find("two dates of this ground, 150 tiles"), std::string::npos);
  for (TileScores& score : scores) score.level_tiles = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(rests_on(), "");
}

TEST(RouteOverLevels, ExpectedFixesAreThoseOfTheMean) {
  const Mission mission = testing::straight_mission(2000);
  EXPECT_NEAR(selected(mission, 0.6, 2).probability->expected_fixes,
              selected(mission, 0.6, 0).probability->expected_fixes, 1e-9);
}

}  // namespace
}  // namespace pilotage
