#include "pilotage/select/route_ageing.h"

#include <cmath>

#include "straight_mission.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/ground/place_level.h"
#include "pilotage/matchability/level_at_age.h"
#include "pilotage/select/select_tiles.h"

namespace pilotage {
namespace {

constexpr double kLogit = 0.6;
constexpr double kSigma = 1.4;
constexpr double kYear_months = 365 / (365.2425 / 12);

Mission dated_mission(const std::string& acquired, const std::string& flight_time) {
  Mission mission = testing::straight_mission(2500, 50, 2);
  mission.ground.imagery.datasets.resize(1);
  mission.ground.imagery.datasets[0].acquired = acquired;
  mission.ground.flight_time = flight_time;
  return mission;
}

/// Of a place with a level of its own at kAgeOfLevel_months: as a model that counts the age scores the tiles.
std::vector<TileScores> scores_at(const Mission& mission, double age_months, double logit = kLogit) {
  const LevelMove move = move_level(kSigma, kAgeOfLevel_months, age_months);
  std::vector<TileScores> scores = testing::good_scores(mission);
  for (TileScores& score : scores) {
    score.p_correct_fix = p_over_level(logit + move.mean_shift, move.sigma);
    score.level_sigma = move.sigma;
    score.level_tiles = 0;
    score.level_age_months = age_months;
  }
  return scores;
}

Selection selected(const Mission& mission, const std::vector<TileScores>& scores, double asked_for) {
  SelectOptions options;
  options.min_route_probability = asked_for;
  options.min_p_correct_fix = 0;
  return select_tiles(mission, scores, testing::kStoredSize, options);
}

RouteProbability route_at(const Mission& mission, double age_months) {
  return *selected(mission, scores_at(mission, age_months), 0.5).probability;
}

TEST(RouteAgeing, IsWhatIsPlannedOnALaterDay) {
  const Mission mission = dated_mission("2025-01-01", "2026-01-01");
  const std::vector<TileScores> scores = scores_at(mission, kYear_months);
  const Selection selection = selected(mission, scores, 0.5);
  const auto ageing = age_route(mission, scores, selection);
  ASSERT_TRUE(ageing);
  ASSERT_EQ(ageing->ages.size(), 5u);
  EXPECT_EQ(selection.probability->level_age_months, kYear_months);
  EXPECT_EQ(ageing->ages.front().p_within_limit, selection.probability->p_within_limit);
  double before = 1;
  for (const ChancesAtAge& at : ageing->ages) {
    const RouteProbability planned = route_at(mission, at.age_months);
    EXPECT_NEAR(at.p_within_limit, planned.p_within_limit, 1e-6) << at.age_months;
    EXPECT_NEAR(at.interval.low, planned.interval->low, 1e-6) << at.age_months;
    EXPECT_NEAR(at.interval.high, planned.interval->high, 1e-6) << at.age_months;
    EXPECT_LT(at.p_within_limit, before);
    before = at.p_within_limit;
  }
  EXPECT_NEAR(ageing->ages.back().age_months, kYear_months + 48, 1e-9);
}

TEST(RouteAgeing, GroundWithoutFeaturesHasNoLevelAndHidesNoAge) {
  const Mission mission = dated_mission("2025-01-01", "2026-01-01");
  std::vector<TileScores> scores = scores_at(mission, kYear_months);
  scores[0].p_correct_fix = 0;
  scores[0].level_sigma = scores[0].level_age_months = kNaN;
  const std::vector<bool> all(scores.size(), true);
  EXPECT_EQ(counted_age_months(scores, all), kYear_months);
  scores[0].p_correct_fix = 0.5;
  EXPECT_FALSE(counted_age_months(scores, all)) << "of a model that does not count it";
}

TEST(RouteAgeing, FindsTheAgeAtWhichItIsJustEnough) {
  const Mission mission = dated_mission("2025-01-01", "2026-01-01");
  const std::vector<TileScores> scores = scores_at(mission, kYear_months);
  for (const double age_months : {20.0, 55.0, 120.0}) {
    const RouteProbability then = route_at(mission, age_months);
    const auto of_mean = age_route(mission, scores, selected(mission, scores, then.p_within_limit));
    EXPECT_NEAR(of_mean->enough_up_to_months.value_or(0), age_months, 0.05 * age_months);
    const auto of_low = age_route(mission, scores, selected(mission, scores, then.interval->low));
    EXPECT_NEAR(of_low->surely_up_to_months.value_or(0), age_months, 0.05 * age_months);
    EXPECT_GT(of_low->enough_up_to_months.value_or(0), age_months);
  }
  const auto always = age_route(mission, scores, selected(mission, scores, 0.01));
  EXPECT_EQ(always->enough_up_to_months, kMostAge_months);
}

TEST(RouteAgeing, OfAPlanThatIsNotEnoughItFindsYoungerImagery) {
  const Mission mission = dated_mission("2021-01-01", "2026-01-01");
  const std::vector<TileScores> scores = scores_at(mission, 1826 / (365.2425 / 12));
  const double asked_for = route_at(mission, 10).p_within_limit;
  const auto ageing = age_route(mission, scores, selected(mission, scores, asked_for));
  EXPECT_NEAR(ageing->enough_up_to_months.value_or(0), 10, 0.3);
  EXPECT_FALSE(ageing->surely_up_to_months);
  EXPECT_FALSE(age_route(mission, scores, selected(mission, scores, 0.9999))->enough_up_to_months);
}

TEST(RouteAgeing, IsNotSaidWherePCountsNoAge) {
  const Mission mission = dated_mission("2025-01-01", "2026-01-01");
  std::vector<TileScores> scores = scores_at(mission, kYear_months);
  const Selection selection = selected(mission, scores, 0.5);
  EXPECT_TRUE(age_route(mission, scores, selection));
  EXPECT_THROW(age_route(dated_mission("2025-01-01", ""), scores, selection), DataError)
      << "P counts what nobody knows";
  EXPECT_THROW(age_route(dated_mission("", "2026-01-01"), scores, selection), DataError);
  EXPECT_FALSE(age_route(dated_mission("2027-01-01", "2026-01-01"), scores, selection)) << "later flights are nearer";
  Selection without = selection;
  without.probability.reset();
  EXPECT_FALSE(age_route(mission, scores, without));
  EXPECT_THROW(age_route(dated_mission("2025-02-01", "2026-01-01"), scores, selection), DataError) << "scored before";
  scores.front().level_age_months = kYear_months + 1;
  EXPECT_THROW(age_route(mission, scores, selection), DataError) << "two tables in one";
  for (TileScores& score : scores) score.level_age_months = kNaN;
  EXPECT_FALSE(age_route(mission, scores, selection));
  scores.pop_back();
  EXPECT_THROW(age_route(mission, scores, selection), DataError);
}

TEST(RouteAgeing, FliesWithTheGnssOfThePlan) {
  const Mission lost_at_start = dated_mission("2025-01-01", "2026-01-01");
  Mission mission = lost_at_start;
  mission.flight.denied.stretches = {{800, 1700}};
  const std::vector<TileScores> scores = scores_at(mission, kYear_months);
  const auto ageing = age_route(mission, scores, selected(mission, scores, 0.5));
  const ChancesAtAge& later = ageing->ages[2];
  EXPECT_NEAR(later.p_within_limit, route_at(mission, later.age_months).p_within_limit, 1e-6);
  EXPECT_GT(later.p_within_limit, route_at(lost_at_start, later.age_months).p_within_limit + 0.01);
}

TEST(RouteAgeing, OfImageryOfADayAndOfDecades) {
  const Mission mission = dated_mission("2026-01-01", "2026-01-02T12:00:00Z");
  const double day_months = 1.5 / (365.2425 / 12);
  std::vector<TileScores> scores = scores_at(mission, day_months);
  const double asked_for = route_at(mission, 6).p_within_limit;
  const auto young = age_route(mission, scores, selected(mission, scores, asked_for));
  EXPECT_NEAR(young->ages.front().age_months, day_months, 1e-9);
  EXPECT_NEAR(young->enough_up_to_months.value_or(0), 6, 0.5);
  const Mission old_mission = dated_mission("2006-01-01", "2026-01-01");
  scores = scores_at(old_mission, 7305 / (365.2425 / 12));
  const auto old = age_route(old_mission, scores, selected(old_mission, scores, 0.01));
  EXPECT_FALSE(old) << "nothing is known of later ones";
}

}  // namespace
}  // namespace pilotage
