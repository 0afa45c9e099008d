#include "pilotage/select/route_probability.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <string>

#include "select/straight_mission.h"
#include <gtest/gtest.h>

#include "pilotage/base/random.h"
#include "pilotage/ins/drift.h"

namespace pilotage {
namespace {

using testing::error_after_s;
using testing::straight_mission;

// What became of one flight: the sample at which its error exceeded the limit (the number of samples: never), and of
// each leg whether it had a fix on it before.
struct OneFlight {
  std::size_t lost_at = 0;
  std::vector<bool> fix_on_leg;
};

// One flight with its own covariance and all of its history; `succeeds(sample)` says whether the attempt there does.
OneFlight fly_once(const FlightPath& path, const std::vector<double>& p_fix,
                   const std::function<bool(std::size_t)>& succeeds) {
  const std::vector<FlightSample>& samples = path.mission->flight.samples;
  OneFlight flight{samples.size(), std::vector<bool>(path.mission->flight.route.legs.size(), false)};
  InsState state = initial_ins_state(path.model, samples[0].azimuth_deg, samples[0].speed_mps);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (position_error_m(state, path.model.sigma_multiple) > path.max_error_m) {
      flight.lost_at = i;
      return flight;
    }
    if (p_fix[i] > 0 && succeeds(i)) {
      state = update_with_fix(state, path.model.fix_sigma_m);
      flight.fix_on_leg[static_cast<std::size_t>(samples[i].leg)] = true;
    }
    if (i + 1 < samples.size()) state = propagate(state, path.steps[i]);
  }
  return flight;
}

// Each try decided on its own.
RouteChances independent(const std::vector<double>& p_fix) {
  RouteChances chances{p_fix, std::vector<std::int64_t>(p_fix.size()), 0, 0, {}};
  std::iota(chances.window.begin(), chances.window.end(), 0);
  return chances;
}

// A fix may come at every `step`-th sample, with probabilities drawn from [low, high).
std::vector<double> random_p_fix(const Mission& mission, std::size_t step, double low, double high, Random& random) {
  std::vector<double> p_fix(mission.flight.samples.size(), 0.0);
  for (std::size_t i = step; i < p_fix.size(); i += step) p_fix[i] = random.uniform(low, high);
  return p_fix;
}

TEST(RouteProbability, WithoutFixesAFlightIsLostWhereTheDriftReachesTheLimit) {
  const Mission mission = straight_mission(3000);
  const FlightPath path = make_flight_path(mission, error_after_s(mission, 60.1));  // at 20 m/s: 1,202 m
  const RouteSurvival survival =
      predict_survival(path, independent(std::vector<double>(mission.flight.samples.size(), 0.0)));
  EXPECT_EQ(survival.p_within_limit[120], 1);
  EXPECT_EQ(survival.p_within_limit[121], 0);
  EXPECT_EQ(survival.leg_p_within_limit[0], 0);
  EXPECT_EQ(survival.leg_p_fix[0], 0);
  ASSERT_TRUE(survival.worst);
  EXPECT_EQ(survival.worst->from_distance_m, 0);
  EXPECT_EQ(survival.worst->to_distance_m, 1210);
  EXPECT_EQ(survival.worst->p_first_excess, 1);
}

TEST(RouteProbability, OneAttemptThatIsNeededIsTheProbability) {
  const Mission mission = straight_mission(1800, 50, 2);
  const FlightPath path = make_flight_path(mission, error_after_s(mission, 60.1));
  std::vector<double> p_fix(mission.flight.samples.size(), 0.0);
  p_fix[111] = 0.7;  // at 1,100 m; the drift reaches the limit at 1,202 m
  const RouteSurvival survival = predict_survival(path, independent(p_fix));
  EXPECT_EQ(survival.p_within_limit[111], 1);
  EXPECT_NEAR(survival.p_within_limit.back(), 0.7, 1e-15);
  EXPECT_EQ(survival.leg_p_within_limit[0], 1);
  EXPECT_NEAR(survival.leg_p_within_limit[1], 0.7, 1e-15);
  EXPECT_EQ(survival.leg_p_fix[0], 0);
  EXPECT_NEAR(survival.leg_p_fix[1], 0.7, 1e-15);
  ASSERT_TRUE(survival.worst);
  EXPECT_NEAR(survival.worst->p_first_excess, 0.3, 1e-15);
}

TEST(RouteProbability, ALegThatNoFlightReachesHasNone) {
  const Mission mission = straight_mission(4000, 50, 2);
  const FlightPath path = make_flight_path(mission, error_after_s(mission, 30));
  const RouteSurvival survival =
      predict_survival(path, independent(std::vector<double>(mission.flight.samples.size(), 0.0)));
  EXPECT_EQ(survival.leg_p_within_limit[0], 0);
  EXPECT_TRUE(std::isnan(survival.leg_p_within_limit[1]));
  EXPECT_TRUE(std::isnan(survival.leg_p_fix[1]));
}

// Adds `p` to `alive` for each sample that a flight reaches within the limit, over both outcomes of every attempt from
// `sample` on, each with the covariance of its own history.
void fly_every_outcome(const FlightPath& path, const std::vector<double>& p_fix, std::size_t sample, double p,
                       InsState state, std::vector<double>& alive) {
  for (std::size_t i = sample; i < p_fix.size(); ++i) {
    if (position_error_m(state, path.model.sigma_multiple) > path.max_error_m) return;
    alive[i] += p;
    if (i + 1 == p_fix.size()) return;
    if (p_fix[i] > 0) {
      const InsState fixed = propagate(update_with_fix(state, path.model.fix_sigma_m), path.steps[i]);
      fly_every_outcome(path, p_fix, i + 1, p * p_fix[i], fixed, alive);
      p *= 1 - p_fix[i];
    }
    state = propagate(state, path.steps[i]);
  }
}

// The recursion merges histories that are nearly alike, and must stay close.
TEST(RouteProbability, AgreesWithEveryOutcomeOfTenAttempts) {
  struct Inertial {
    InsGrade grade;
    double velocity_aid_mps;
  };
  for (const auto& [grade, velocity_aid_mps] :
       {Inertial{InsGrade::kTactical, 0}, Inertial{InsGrade::kIndustrial, 0}, Inertial{InsGrade::kVisualOdometry, 0},
        Inertial{InsGrade::kIndustrial, 1}}) {
    Mission mission = straight_mission(4400, 50, 2);
    mission.flight.ins.grade = grade;
    if (velocity_aid_mps > 0) mission.flight.ins.velocity_aid_sigma_mps = velocity_aid_mps;
    Random random(seed_from_name("AgreesWithEveryOutcomeOfTenAttempts"));
    for (int round = 0; round < 3; ++round) {
      const std::vector<double> p_fix = random_p_fix(mission, 40, 0.2, 0.95, random);
      EXPECT_GE(std::count_if(p_fix.begin(), p_fix.end(), [](double p) { return p > 0; }), 10);
      // Between two samples: where the error is the limit's at one of them, rounding decides who is lost there.
      const FlightPath path = make_flight_path(mission, error_after_s(mission, 45.1 + 15 * round));
      std::vector<double> exact(p_fix.size(), 0.0);
      fly_every_outcome(path, p_fix, 0, 1, first_branches(path).front().state, exact);
      const RouteSurvival survival = predict_survival(path, independent(p_fix));
      double largest = 0;
      for (std::size_t i = 0; i < exact.size(); ++i) {
        const double difference = survival.p_within_limit[i] - exact[i];
        if (std::abs(difference) > std::abs(largest)) largest = difference;
      }
      // With an aiding velocity the error hardly grows where it comes to the limit: small differences decide.
      EXPECT_LT(std::abs(largest), velocity_aid_mps > 0 ? 0.07 : 0.04)
          << "grade " << static_cast<int>(grade) << ", round " << round;
      RecordProperty("difference_" + std::to_string(static_cast<int>(grade)) +
                         (velocity_aid_mps > 0 ? "_aided_" : "_") + std::to_string(round),
                     std::to_string(largest) + " of " + std::to_string(exact.back()));
    }
  }
}

// Errors are held against the limit where tries are, and seldom else: who is lost between is found there all the same.
TEST(RouteProbability, IsTheSameWhereErrorsAreLookedAtAtEverySample) {
  for (const InsGrade grade : {InsGrade::kTactical, InsGrade::kIndustrial, InsGrade::kVisualOdometry}) {
    Mission mission = straight_mission(6000, 10, 3);
    mission.flight.ins.grade = grade;
    Random random(seed_from_name("IsTheSameWhereErrorsAreLookedAtAtEverySample"));
    const std::vector<double> p_fix = random_p_fix(mission, 37, 0.5, 0.95, random);
    for (FlightSample& at : mission.flight.samples) at.azimuth_deg += 75 * at.leg;  // turns, and tries after them
    Mission uneven = mission;                                                       // no two steps are the same
    for (std::size_t i = 1; i + 1 < p_fix.size(); i += 2) {
      FlightSample& at = uneven.flight.samples[i];
      if (uneven.flight.samples[i + 1].leg == at.leg && at.distance_m > uneven.flight.samples[i - 1].distance_m) {
        at.distance_m += 3e-4;
      }
    }
    const FlightPath path = make_flight_path(mission, error_after_s(mission, 41));
    const RouteSurvival survival = predict_survival(path, independent(p_fix));
    const RouteSurvival slow = predict_survival(make_flight_path(uneven, path.max_error_m), independent(p_fix));
    ASSERT_EQ(survival.p_within_limit.size(), p_fix.size());
    EXPECT_GT(survival.p_within_limit.back(), 0.01);
    EXPECT_LT(survival.p_within_limit.back(), 0.99);
    for (std::size_t i = 0; i < p_fix.size(); ++i) {
      EXPECT_NEAR(survival.p_within_limit[i], slow.p_within_limit[i], 1e-4) << i;
    }
  }
}

// Of flights that had their last fix together, those that hold next to nothing are one branch, and none of them is lost
// by it.
TEST(RouteProbability, RareFlightsOfOneFixBecomeOneBranch) {
  const Mission mission = straight_mission(6000, 50);
  Random random(seed_from_name("RareFlightsOfOneFixBecomeOneBranch"));
  const std::vector<double> p_fix = random_p_fix(mission, 4, 0.5, 0.8, random);
  const FlightPath path = make_flight_path(mission, error_after_s(mission, 400));
  const FlightStretch flown = fly_stretch(path, path.steps, independent(p_fix), 0, p_fix.size(), first_branches(path));
  double total = 0;
  for (const FlightBranch& branch : flown.branches) total += branch.probability;
  EXPECT_NEAR(total, 1, 1e-6);
  std::map<std::size_t, int> rare;  // by the sample of the last fix
  for (const FlightBranch& branch : flown.branches) rare[branch.fix_sample] += branch.probability < 1e-4 ? 1 : 0;
  EXPECT_GT(rare.size(), 10U);
  for (const auto& [fix_sample, count] : rare) EXPECT_LE(count, 1) << fix_sample;
}

// Many flights, each with its own luck and its own covariance.
TEST(RouteProbability, AgreesWithSimulatedFlights) {
  const Mission mission = straight_mission(6000, 50, 4);
  Random random(seed_from_name("AgreesWithSimulatedFlights"));
  const std::vector<double> p_fix = random_p_fix(mission, 13, 0.1, 0.7, random);
  const FlightPath path = make_flight_path(mission, error_after_s(mission, 40));
  constexpr int kFlights = 4000;
  std::vector<double> alive(p_fix.size(), 0.0);
  std::vector<double> with_fix(4, 0.0);
  for (int n = 0; n < kFlights; ++n) {
    const OneFlight flight = fly_once(path, p_fix, [&](std::size_t i) { return random.uniform() < p_fix[i]; });
    for (std::size_t i = 0; i < flight.lost_at; ++i) ++alive[i];
    for (std::size_t leg = 0; leg < 4; ++leg) with_fix[leg] += flight.fix_on_leg[leg] ? 1 : 0;
  }
  const RouteSurvival survival = predict_survival(path, independent(p_fix));
  const double p_end = survival.p_within_limit.back();
  EXPECT_GT(p_end, 0.2);
  EXPECT_LT(p_end, 0.8);
  for (std::size_t i = 0; i < alive.size(); i += 10) {
    EXPECT_NEAR(survival.p_within_limit[i], alive[i] / kFlights, 4 * 0.5 / std::sqrt(kFlights) + 0.02) << i;
  }
  double entering = kFlights;
  double product = 1;
  for (std::size_t leg = 0; leg < 4; ++leg) {
    EXPECT_NEAR(survival.leg_p_fix[leg], with_fix[leg] / entering, 4 * 0.5 / std::sqrt(entering) + 0.02) << leg;
    entering = alive[(leg + 1) * 151 - 1];
    product *= survival.leg_p_within_limit[leg];
  }
  EXPECT_NEAR(product, p_end, 1e-12);
}

// One draw for each window of four tries, and a least time between fixes.
TEST(RouteProbability, AgreesWithSimulatedFlightsWhereTriesDependOnEachOther) {
  const Mission mission = straight_mission(4000);
  Random random(seed_from_name("AgreesWithSimulatedFlightsWhereTriesDependOnEachOther"));
  for (const double fix_interval_s : {0.0, 9.0}) {
    RouteChances chances{random_p_fix(mission, 9, 0.3, 0.9, random), {}, fix_interval_s, 0, {}};
    for (std::size_t i = 0; i < chances.p.size(); ++i) chances.window.push_back(static_cast<std::int64_t>(i / 36));
    const FlightPath path = make_flight_path(mission, error_after_s(mission, 34));
    constexpr int kFlights = 3000;
    std::vector<double> alive(chances.p.size(), 0.0);
    for (int n = 0; n < kFlights; ++n) {
      std::vector<double> draws(chances.p.size() / 36 + 1);
      for (double& draw : draws) draw = random.uniform();
      double last_fix_s = -1e9;
      const OneFlight flight = fly_once(path, chances.p, [&](std::size_t i) {
        const double time_s = mission.flight.samples[i].distance_m / 20;
        if (time_s - last_fix_s < fix_interval_s - 1e-9 || draws[i / 36] >= chances.p[i]) return false;
        last_fix_s = time_s;
        return true;
      });
      for (std::size_t i = 0; i < flight.lost_at; ++i) ++alive[i];
    }
    const RouteSurvival survival = predict_survival(path, chances);
    EXPECT_GT(survival.p_within_limit.back(), 0.1);
    EXPECT_LT(survival.p_within_limit.back(), 0.9);
    for (std::size_t i = 0; i < alive.size(); i += 10) {
      EXPECT_NEAR(survival.p_within_limit[i], alive[i] / kFlights, 4 * 0.5 / std::sqrt(kFlights) + 0.02)
          << i << ", interval " << fix_interval_s;
    }
  }
}

TEST(RouteProbability, AFixMoreLikelyNeverHurts) {
  const Mission mission = straight_mission(6000);
  Random random(seed_from_name("AFixMoreLikelyNeverHurts"));
  std::vector<double> p_fix = random_p_fix(mission, 20, 0.1, 0.6, random);
  const FlightPath path = make_flight_path(mission, error_after_s(mission, 40));
  const double before = predict_survival(path, independent(p_fix)).p_within_limit.back();
  for (std::size_t i = 20; i < p_fix.size(); i += 60) {
    std::vector<double> better = p_fix;
    better[i] = 0.9;
    EXPECT_GT(predict_survival(path, independent(better)).p_within_limit.back(), before - 0.002) << i;
  }
  std::vector<double> certain = p_fix;
  for (double& p : certain) p = p > 0 ? 1 : 0;
  const RouteSurvival survival = predict_survival(path, independent(certain));
  EXPECT_EQ(survival.p_within_limit.back(), 1);
  EXPECT_FALSE(survival.worst);
}

TEST(RouteProbability, TheWorstStretchIsTheGap) {
  const Mission mission = straight_mission(6000);
  const FlightPath path = make_flight_path(mission, error_after_s(mission, 60));
  std::vector<double> p_fix(mission.flight.samples.size(), 0.0);
  for (std::size_t i = 10; i < p_fix.size(); i += 10) {
    if (i < 300 || i >= 400) p_fix[i] = 0.6;
  }
  const RouteSurvival survival = predict_survival(path, independent(p_fix));
  ASSERT_TRUE(survival.worst);
  EXPECT_GE(survival.worst->from_distance_m, 2300);
  EXPECT_LE(survival.worst->from_distance_m, 2900);
  EXPECT_LE(survival.worst->to_distance_m, 4300);
  EXPECT_GT(survival.worst->p_first_excess, (1 - survival.p_within_limit.back()) / 2);
}

}  // namespace
}  // namespace pilotage
