#include "pilotage/select/route_error.h"

#include <algorithm>

#include "select/straight_mission.h"
#include "testing/drift_after.h"
#include <gtest/gtest.h>

#include "pilotage/ins/drift.h"

namespace pilotage {
namespace {

using testing::straight_mission;

// Matchable within any of the stretches, given as distances along the route.
std::vector<bool> matchable_in(const Mission& mission, const std::vector<std::pair<double, double>>& stretches) {
  std::vector<bool> matchable;
  for (const FlightSample& sample : mission.flight.samples) {
    matchable.push_back(std::any_of(stretches.begin(), stretches.end(), [&](const auto& stretch) {
      return sample.distance_m >= stretch.first && sample.distance_m <= stretch.second;
    }));
  }
  return matchable;
}

double error_after_fix_sequence(const Mission& mission, const std::vector<bool>& matchable) {
  return predict_route_error(mission, matchable, mission.flight.max_error_m, 0.1).profile.back().error_m;
}

TEST(RouteError, WithoutFixesIsTheDriftOfTheGrade) {
  const Mission mission = straight_mission(4000);
  const RouteError error = predict_route_error(mission, std::vector<bool>(mission.flight.samples.size(), false),
                                               mission.flight.max_error_m, 2);
  const InsErrorModel model = make_ins_error_model(mission.flight.ins);
  const double expected_m =
      position_error_m(testing::drift_after(model, 4000.0 / 20.0, 20, model.start_sigma_m), model.sigma_multiple);
  EXPECT_NEAR(error.profile.back().error_m, expected_m, 1e-6 * expected_m);
  ASSERT_EQ(error.gaps.size(), 1U);
  EXPECT_EQ(error.gaps[0].from_distance_m, 0);
  EXPECT_EQ(error.gaps[0].to_distance_m, 4000);
  EXPECT_NEAR(error.gaps[0].duration_s, 200, 1e-9);
  EXPECT_EQ(error.gaps[0].error_m, error.profile.back().error_m);
  EXPECT_EQ(error.matchable_fraction, 0);
  EXPECT_EQ(error.within_limit, expected_m <= mission.flight.max_error_m);
}

TEST(RouteError, FixesHoldTheErrorDownAndGapsLieBetweenThem) {
  const Mission mission = straight_mission(4000, 50, 2);
  const auto matchable = matchable_in(mission, {{0, 1000}, {1500, 2500}, {3500, 4000}});
  const RouteError error = predict_route_error(mission, matchable, mission.flight.max_error_m, 2);
  ASSERT_EQ(error.gaps.size(), 2U);
  EXPECT_EQ(error.gaps[0].from_distance_m, 1000);
  EXPECT_EQ(error.gaps[0].to_distance_m, 1500);
  EXPECT_NEAR(error.gaps[0].duration_s, 25, 1e-9);
  EXPECT_EQ(error.gaps[0].leg, 0);
  EXPECT_EQ(error.gaps[1].from_distance_m, 2500);
  EXPECT_EQ(error.gaps[1].to_distance_m, 3500);
  EXPECT_EQ(error.gaps[1].leg, 1);
  EXPECT_GT(error.gaps[1].error_m, error.gaps[0].error_m);
  EXPECT_NEAR(error.matchable_fraction, 2500.0 / 4000, 1e-9);
  ASSERT_EQ(error.legs.size(), 2U);
  EXPECT_NEAR(error.legs[0].matchable_fraction, 1500.0 / 2000, 1e-9);
  EXPECT_NEAR(error.legs[1].matchable_fraction, 1000.0 / 2000, 1e-9);
  const double unaided_m = error_after_fix_sequence(mission, std::vector<bool>(matchable.size(), false));
  EXPECT_LT(error.profile.back().error_m, unaided_m / 2);
}

TEST(RouteError, AFixTakenMoreOftenDoesNotHurt) {
  const Mission mission = straight_mission(3000);
  const std::vector<bool> all(mission.flight.samples.size(), true);
  const double often_m = predict_route_error(mission, all, 50, 0.5).profile.back().error_m;
  const double seldom_m = predict_route_error(mission, all, 50, 30).profile.back().error_m;
  EXPECT_LE(often_m, seldom_m);
}

// All subsets of the matchable samples on a coarse route: the least number of fixes that holds the limit.
std::size_t fewest_by_brute_force(const Mission& mission, const std::vector<bool>& matchable, double max_error_m) {
  std::vector<std::size_t> candidates;
  for (std::size_t i = 1; i < matchable.size(); ++i) {
    if (matchable[i]) candidates.push_back(i);
  }
  std::size_t best = candidates.size() + 1;
  for (unsigned subset = 0; subset < (1U << candidates.size()); ++subset) {
    const auto size = static_cast<std::size_t>(__builtin_popcount(subset));
    if (size >= best) continue;
    std::vector<bool> fixes(matchable.size(), false);
    for (std::size_t k = 0; k < candidates.size(); ++k) fixes[candidates[k]] = (subset >> k & 1U) != 0;
    if (predict_route_error(mission, fixes, max_error_m, 0.01).within_limit) best = size;
  }
  return best;
}

TEST(FewestFixSamples, IsAsFewAsAnySubset) {
  Mission mission = straight_mission(20000);
  std::vector<FlightSample> coarse;
  for (std::size_t i = 0; i < mission.flight.samples.size(); i += 200) coarse.push_back(mission.flight.samples[i]);
  mission.flight.samples = coarse;  // 11 samples, 2 km apart
  const std::vector<bool> matchable(coarse.size(), true);
  const InsErrorModel model = make_ins_error_model(mission.flight.ins);
  for (const double gap_s : {150.0, 250.0, 420.0}) {
    const double limit_m =
        position_error_m(testing::drift_after(model, gap_s, 20, model.start_sigma_m), model.sigma_multiple);
    const auto fixes = fewest_fix_samples(mission, matchable, limit_m);
    std::vector<bool> taken(coarse.size(), false);
    for (const std::size_t i : fixes) taken[i] = true;
    EXPECT_TRUE(predict_route_error(mission, taken, limit_m, 0.01).within_limit) << gap_s;
    EXPECT_EQ(fixes.size(), fewest_by_brute_force(mission, matchable, limit_m)) << gap_s;
  }
}

TEST(FewestFixSamples, TakesTheNextChanceWhereTheLimitCannotHold) {
  const Mission mission = straight_mission(20000);
  const auto matchable = matchable_in(mission, {{15000, 15100}});
  const auto fixes = fewest_fix_samples(mission, matchable, 15);
  ASSERT_FALSE(fixes.empty());
  EXPECT_GE(mission.flight.samples[fixes[0]].distance_m, 15000);
  EXPECT_LE(mission.flight.samples[fixes[0]].distance_m, 15100);
}

}  // namespace
}  // namespace pilotage
