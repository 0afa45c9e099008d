#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "select/straight_mission.h"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/random.h"
#include "pilotage/mission/selection_file.h"
#include "pilotage/select/route_error.h"
#include "pilotage/select/select_tiles.h"
#include "pilotage/select/worst_loss.h"

namespace pilotage {
namespace {

using testing::error_after_s;
using testing::good_scores;
using testing::kStoredSize;
using testing::straight_mission;

Mission denied_mission(double length_m, std::vector<DeniedStretch> stretches, int legs = 1) {
  Mission mission = straight_mission(length_m, 50, legs);
  mission.flight.denied.stretches = std::move(stretches);
  return mission;
}

std::vector<bool> nowhere(const Mission& mission) {
  return std::vector<bool>(mission.flight.samples.size(), false);
}

// P of each tile drawn from [low, high).
std::vector<TileScores> random_scores(const Mission& mission, double low, double high, const std::string& name) {
  std::vector<TileScores> scores = good_scores(mission);
  Random random(seed_from_name(name));
  for (TileScores& score : scores) score.p_correct_fix = random.uniform(low, high);
  return scores;
}

double largest_error_m(const Selection& selection) {
  double largest = 0;
  for (const ErrorSample& sample : selection.error_profile) largest = std::max(largest, sample.error_m);
  return largest;
}

// An odometer without any other error: one axis, its position error p and its drift a. Holding p at σ0 teaches a.
struct OdometerAxis {
  double pp = 9;
  double pa = 0;
  double aa = 0.5 * 0.02 * 0.02;

  void fly(double way_m) {
    pp += 2 * way_m * pa + way_m * way_m * aa;
    pa += way_m * aa;
  }
  void hold() {
    const double noise = 9 * pp / (pp - 9);  // with which a measurement of p leaves 9
    if (!(pp > 9)) return;
    const double gain_p = pp / (pp + noise);
    const double gain_a = pa / (pp + noise);
    aa -= gain_a * pa;
    pa -= gain_p * pa;
    pp -= gain_p * pp;
  }
};

TEST(DeniedStretches, TheErrorIsThatOfTheWaySinceEachLoss) {
  Mission mission = denied_mission(4000, {{500, 1500}, {2504, 2996}}, 2);
  mission.flight.ins.grade = InsGrade::kCustom;
  mission.flight.ins.odometry_drift_percent = 2;
  const RouteError error = predict_route_error(mission, nowhere(mission), 30, 2);
  OdometerAxis axis;
  double before_m = 0;
  double after_first = 0;
  double after_second = 0;
  for (const ErrorSample& sample : error.profile) {
    const double at_m = sample.distance_m;
    axis.fly(at_m - before_m);
    before_m = at_m;
    // Lost at the sample before, had again at the one behind.
    const bool denied = (at_m > 500 && at_m <= 1500) || (at_m > 2500 && at_m <= 3000);
    if (!denied) axis.hold();
    EXPECT_NEAR(sample.error_m, 3 * std::sqrt(axis.pp), 1e-9) << at_m;
    if (at_m == 1000) after_first = sample.error_m;
    if (at_m == 3000) after_second = sample.error_m;
    if (at_m == 1500 || at_m == 3000) axis.hold();
  }
  EXPECT_GT(after_first, 12) << "the drift of 500 m without GNSS shows beside the 9 m of its loss";
  EXPECT_LT(after_second, 0.8 * after_first) << "GNSS back after the first stretch has shown the drift";
  ASSERT_EQ(error.gaps.size(), 2U);
  EXPECT_EQ(error.gaps[0].from_distance_m, 500);
  EXPECT_EQ(error.gaps[0].to_distance_m, 1500);
  EXPECT_GT(error.gaps[0].error_m, 30);
  EXPECT_FALSE(error.gaps[0].within_limit);
  EXPECT_EQ(error.gaps[1].from_distance_m, 2500);
  EXPECT_EQ(error.gaps[1].to_distance_m, 3000);
  EXPECT_EQ(error.gaps[1].leg, 1);
  EXPECT_TRUE(error.gaps[1].within_limit);
  EXPECT_FALSE(error.legs[0].within_limit);
  EXPECT_TRUE(error.legs[1].within_limit);
}

TEST(DeniedStretches, AStretchOverAllOfTheRouteIsTheLossAtTheFirstPoint) {
  const Mission lost_first = straight_mission(3000, 50, 2);
  const Mission denied = denied_mission(3000, {{0, 3000}}, 2);
  const std::vector<TileScores> scores = random_scores(lost_first, 0.1, 0.9, "AllOfTheRoute");
  SelectOptions options;
  options.advise = true;
  for (const bool sparse : {false, true}) {
    options.sparse = sparse;
    EXPECT_EQ(selection_to_json(select_tiles(denied, scores, kStoredSize, options)).dump(),
              selection_to_json(select_tiles(lost_first, scores, kStoredSize, options)).dump());
  }
}

RouteChances tries_at(const Mission& mission, const std::vector<std::pair<std::size_t, double>>& tries) {
  RouteChances chances{std::vector<double>(mission.flight.samples.size(), 0.0),
                       std::vector<std::int64_t>(mission.flight.samples.size()),
                       0,
                       0,
                       {}};
  std::iota(chances.window.begin(), chances.window.end(), 0);
  for (const auto& [sample, p] : tries) chances.p[sample] = p;
  return chances;
}

// The inertial system holds for some 802 m, more after GNSS; each stretch of 1,200 m needs its one try.
TEST(DeniedStretches, EachNeedsItsOwnFix) {
  const Mission mission = denied_mission(3200, {{200, 1400}, {1800, 3000}});
  const FlightPath path = make_flight_path(mission, error_after_s(mission, 40.1));
  const RouteSurvival survival = predict_survival(path, tries_at(mission, {{90, 0.7}, {250, 0.6}}));
  const auto profile = predict_route_error(mission, nowhere(mission), path.max_error_m, 2).profile;
  std::size_t lost = 0;
  while (profile[lost].error_m <= path.max_error_m) ++lost;
  EXPECT_GE(lost, 101U);
  EXPECT_LE(lost, 120U);
  EXPECT_EQ(survival.p_within_limit[lost - 1], 1);
  EXPECT_NEAR(survival.p_within_limit[lost], 0.7, 1e-12);
  EXPECT_NEAR(survival.p_within_limit[260], 0.7, 1e-12);
  EXPECT_NEAR(survival.p_within_limit.back(), 0.7 * 0.6, 1e-12);
  EXPECT_NEAR(survival.leg_p_fix[0], 0.7, 1e-12);
  ASSERT_TRUE(survival.worst);
  EXPECT_EQ(survival.worst->from_distance_m, 200);
  EXPECT_EQ(survival.worst->to_distance_m, mission.flight.samples[lost].distance_m);
  EXPECT_NEAR(survival.worst->p_first_excess, 0.3, 1e-12);
  const RouteSurvival without = predict_survival(path, tries_at(mission, {{250, 0.6}}));
  EXPECT_EQ(without.p_within_limit.back(), 0);
}

TEST(DeniedStretches, AFixOnALegIsCountedOnce) {
  const Mission mission = denied_mission(2000, {{200, 600}, {1000, 1400}});
  const FlightPath path = make_flight_path(mission, 1000);
  const RouteSurvival survival = predict_survival(path, tries_at(mission, {{40, 0.5}, {120, 0.5}}));
  EXPECT_NEAR(survival.leg_p_fix[0], 0.75, 1e-12);
  EXPECT_EQ(survival.p_within_limit.back(), 1);
}

// Flights with their own luck, windows of tries that depend on each other and reach over the ends of stretches, and
// fixes with GNSS, too.
TEST(DeniedStretches, AgreeWithSimulatedFlights) {
  const Mission mission = denied_mission(4000, {{300, 1700}, {1850, 2900}, {3100, 4000}});
  Random random(seed_from_name("DeniedStretchesAgreeWithSimulatedFlights"));
  RouteChances chances{std::vector<double>(mission.flight.samples.size(), 0.0), {}, 0, 0, {}};
  const FlightPath path = make_flight_path(mission, error_after_s(mission, 30));
  for (std::size_t i = 0; i < chances.p.size(); ++i) {
    chances.window.push_back(static_cast<std::int64_t>(i / 36));
    if (i % 9 == 5) chances.p[i] = random.uniform(0.3, 0.9);
  }
  constexpr int kFlights = 3000;
  std::vector<double> alive(chances.p.size(), 0.0);
  for (int n = 0; n < kFlights; ++n) {
    std::vector<double> draws(chances.p.size() / 36 + 1);
    for (double& draw : draws) draw = random.uniform();
    InsState state = initial_ins_state(path.model, 90, 20);
    for (std::size_t i = 0; i < alive.size(); ++i) {
      if (position_error_m(state, path.model.sigma_multiple) > path.max_error_m) break;
      ++alive[i];
      const double at_m = mission.flight.samples[i].distance_m;
      const auto is_in = [&](double from_m, double to_m) { return at_m >= from_m && at_m < to_m; };
      const bool denied = is_in(300, 1700) || is_in(1850, 2900) || is_in(3100, 4001);
      if (!denied) state = hold_with_gnss(state, 90, 20, path.model);
      if (draws[i / 36] < chances.p[i]) state = update_with_fix(state, path.model.fix_sigma_m);
      if (i + 1 == alive.size()) break;
      state = propagate(state, path.steps[i]);
      if (!denied) state = hold_with_gnss(state, 90, 20, path.model);
    }
  }
  const RouteSurvival survival = predict_survival(path, chances);
  EXPECT_GT(survival.p_within_limit.back(), 0.1);
  EXPECT_LT(survival.p_within_limit.back(), 0.9);
  for (std::size_t i = 0; i < alive.size(); i += 10) {
    EXPECT_NEAR(survival.p_within_limit[i], alive[i] / kFlights, 4 * 0.5 / std::sqrt(kFlights) + 0.02) << i;
  }
}

TEST(DeniedStretches, FewestFixesAreTakenOnlyThere) {
  Mission mission = denied_mission(20000, {{4000, 12000}});
  const double limit_m = error_after_s(mission, 150);
  const std::vector<bool> all(mission.flight.samples.size(), true);
  const auto fixes = fewest_fix_samples(mission, all, limit_m);
  ASSERT_FALSE(fixes.empty());
  for (const std::size_t fix : fixes) {
    EXPECT_GE(mission.flight.samples[fix].distance_m, 4000);
    EXPECT_LT(mission.flight.samples[fix].distance_m, 12000);
  }
  std::vector<bool> taken(all.size(), false);
  for (const std::size_t fix : fixes) taken[fix] = true;
  EXPECT_TRUE(predict_route_error(mission, taken, limit_m, 0.01).within_limit);
  taken[fixes.back()] = false;
  EXPECT_FALSE(predict_route_error(mission, taken, limit_m, 0.01).within_limit);
  mission.flight.denied.stretches = {{4000, 6900}, {7000, 9900}};  // 145 s each
  EXPECT_TRUE(fewest_fix_samples(mission, all, limit_m).empty());
}

TEST(DeniedStretchesThorough, ABudgetIsSpentThere) {
  Mission mission = denied_mission(6000, {{3000, 4600}});
  mission.flight.max_error_m = error_after_s(mission, 40);
  const std::vector<TileScores> scores = random_scores(mission, 0.5, 0.7, "ABudgetIsSpentThere");
  SelectOptions options;
  const double p_of_all = select_tiles(mission, scores, kStoredSize, options).probability->p_within_limit;
  options.budget = "140000";
  const Selection selection = select_tiles(mission, scores, kStoredSize, options);
  EXPECT_GT(selection.probability->p_within_limit, 0.8 * p_of_all);
  mission.flight.denied = {};
  const Selection lost_first = select_tiles(mission, scores, kStoredSize, options);
  EXPECT_LT(lost_first.probability->p_within_limit, 0.5);
}

TEST(DeniedStretches, FixesAreExpectedWithGnssToo) {
  Mission mission = denied_mission(4000, {{1000, 2000}});
  const std::vector<TileScores> scores = random_scores(mission, 0.5, 0.9, "FixesAreExpectedWithGnssToo");
  const Selection denied = select_tiles(mission, scores, kStoredSize, {});
  mission.flight.denied = {};
  EXPECT_EQ(denied.probability->expected_fixes,
            select_tiles(mission, scores, kStoredSize, {}).probability->expected_fixes);
  EXPECT_GT(denied.legs[0].p_fix, 0.99);
}

std::vector<DeniedStretch> random_stretches(Random& random, double length_m) {
  std::vector<DeniedStretch> stretches;
  for (double at_m = random.uniform(0, 0.3 * length_m); at_m < length_m;) {
    const double to_m = std::min(length_m, at_m + random.uniform(200, 0.6 * length_m));
    stretches.push_back({at_m, to_m});
    at_m = to_m + random.uniform(50, 0.4 * length_m);
  }
  return stretches;
}

// A part of each, now and then none of it or all.
std::vector<DeniedStretch> parts_of(const std::vector<DeniedStretch>& stretches, Random& random) {
  std::vector<DeniedStretch> parts;
  for (const DeniedStretch& stretch : stretches) {
    const double length_m = stretch.to_distance_m - stretch.from_distance_m;
    const double from_m = stretch.from_distance_m + length_m * std::max(0.0, random.uniform(-0.5, 1));
    const double to_m = stretch.to_distance_m - length_m * std::max(0.0, random.uniform(-0.5, 1));
    if (to_m > from_m + 1) parts.push_back({from_m, to_m});
  }
  if (parts.empty()) parts.push_back(stretches.front());
  return parts;
}

// The INS at a loss was once no better than at the start, so that less denial could give a smaller P: on the sample
// 0.314 for 1 to 2.4 km and 0.957 for all of it. GNSS may only ever add. What is left is the merging of histories,
// which is exact within some 0.03 (docs/methods/selection.md).
TEST(DeniedStretchesThorough, LessDenialIsNeverWorse) {
  const std::pair<InsGrade, double> grades[] = {{InsGrade::kConsumer, 12},
                                                {InsGrade::kIndustrial, 20},
                                                {InsGrade::kTactical, 40},
                                                {InsGrade::kNavigation, 200},
                                                {InsGrade::kVisualOdometry, 30}};
  Random random(seed_from_name("LessDenialIsNeverWorse"));
  double most_gained = 0;
  double most_lost = 0;
  double most_ratio = 0;
  for (const auto& [grade, reach_s] : grades) {
    for (int n = 0; n < 8; ++n) {
      Mission mission = straight_mission(2000, 50, 2);
      mission.flight.ins.grade = grade;
      mission.flight.max_error_m = error_after_s(mission, reach_s * random.uniform(0.7, 1.5));
      const std::vector<TileScores> scores =
          random_scores(mission, 0.1, random.uniform(0.4, 0.9), "LessDenial" + std::to_string(n));
      std::vector<DeniedStretch> more =
          n % 3 == 0 ? std::vector<DeniedStretch>{{0, 2000}} : random_stretches(random, 2000);
      mission.flight.denied.stretches = more;
      const Selection with_more = select_tiles(mission, scores, kStoredSize, {});
      mission.flight.denied.stretches = parts_of(more, random);
      const Selection with_less = select_tiles(mission, scores, kStoredSize, {});
      for (std::size_t i = 0; i < with_more.error_profile.size(); ++i) {
        most_ratio = std::max(most_ratio, with_less.error_profile[i].error_m / with_more.error_profile[i].error_m);
      }
      const double gained = with_less.probability->p_within_limit - with_more.probability->p_within_limit;
      EXPECT_GT(gained, -0.01) << n << " of " << static_cast<int>(grade);
      most_gained = std::max(most_gained, gained);
      most_lost = std::min(most_lost, gained);
    }
  }
  EXPECT_GT(most_gained, 0.3);
  // A flight that comes back to GNSS with a larger error is told more by it.
  EXPECT_LT(most_ratio, 1.02);
  RecordProperty("most_lost", std::to_string(most_lost));
  RecordProperty("most_ratio", std::to_string(most_ratio));
}

// The numbers of the finding: a start whose tilt and biases are not known yet, fixes, a stretch without any.
TEST(DeniedStretches, FixesBeforeALossAreNotForgotten) {
  Mission mission = straight_mission(4000);
  mission.flight.max_error_m = 50;
  std::vector<TileScores> scores = random_scores(mission, 0.8, 0.9, "FixesBeforeALoss");
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const double at_m = mission.flight.places[i].distance_m;
    if (at_m > 2000 && at_m < 3050) scores[i].p_correct_fix = 0;
  }
  const double all = select_tiles(mission, scores, kStoredSize, {}).probability->p_within_limit;
  mission.flight.denied.stretches = {{1900, 3200}};
  const double part = select_tiles(mission, scores, kStoredSize, {}).probability->p_within_limit;
  EXPECT_GT(all, 0.5);
  EXPECT_GE(part, all);
}

// Every point alone, as a plan that is denied from there to the end, must give the same.
TEST(LossAnywhereThorough, IsTheWorstOfAllSingleLosses) {
  Mission mission = straight_mission(1600, 50, 2);
  mission.flight.max_error_m = error_after_s(mission, 25);
  std::vector<TileScores> scores = random_scores(mission, 0.2, 0.8, "LossAnywhere");
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const double at_m = mission.flight.places[i].distance_m;
    if (at_m > 700 && at_m < 1000) scores[i].p_correct_fix = 0;
  }
  mission.flight.denied.anywhere = true;
  const Selection anywhere = select_tiles(mission, scores, kStoredSize, {});
  ASSERT_TRUE(anywhere.loss_anywhere);
  const LossAnywhere& loss = *anywhere.loss_anywhere;
  EXPECT_EQ(loss.points.size(), 160U);
  EXPECT_EQ(loss.step_m, 10);
  mission.flight.denied.anywhere = false;
  double least_p = 1;
  for (const LossPoint& point : loss.points) {
    mission.flight.denied.stretches = {{point.distance_m, 1600}};
    const Selection single = select_tiles(mission, scores, kStoredSize, {});
    EXPECT_NEAR(point.p_within_limit, single.probability->p_within_limit, 1e-12) << point.distance_m;
    EXPECT_EQ(point.max_error_m, largest_error_m(single)) << point.distance_m;
    EXPECT_LE(point.max_error_m, mission.flight.max_error_m);
    least_p = std::min(least_p, single.probability->p_within_limit);
  }
  EXPECT_NEAR(anywhere.probability->p_within_limit, loss.points[loss.worst].p_within_limit, 1e-12);
  EXPECT_NEAR(anywhere.probability->p_within_limit, least_p, 1e-3);
  mission.flight.denied.stretches = {{loss.points[loss.worst].distance_m, 1600}};
  const Selection single = select_tiles(mission, scores, kStoredSize, {});
  EXPECT_EQ(anywhere.gaps.size(), single.gaps.size());
  EXPECT_EQ(largest_error_m(anywhere), largest_error_m(single));
  EXPECT_EQ(anywhere.within_limit, single.within_limit);
}

// GNSS up to a loss only ever adds, so its loss at the first point is the worst, also where a long gap lies on the way.
TEST(LossAnywhere, ALaterLossIsNeverWorse) {
  Mission mission = straight_mission(2400, 50, 2);
  mission.flight.max_error_m = error_after_s(mission, 60);
  mission.flight.denied.anywhere = true;
  std::vector<TileScores> scores = random_scores(mission, 0.4, 0.8, "ALaterLoss");
  for (std::size_t i = 0; i < scores.size(); ++i) {
    const double at_m = mission.flight.places[i].distance_m;
    if (at_m > 800 && at_m < 2000) scores[i].p_correct_fix = 0;
  }
  const Selection selection = select_tiles(mission, scores, kStoredSize, {});
  ASSERT_TRUE(selection.loss_anywhere);
  const std::vector<LossPoint>& points = selection.loss_anywhere->points;
  EXPECT_EQ(selection.loss_anywhere->worst, 0U);
  EXPECT_LT(points.front().p_within_limit, 0.9);
  EXPECT_GT(points.back().p_within_limit, 0.999);
  double most_p = 0;
  double least_m = std::numeric_limits<double>::infinity();
  for (const LossPoint& point : points) {
    EXPECT_GT(point.p_within_limit, most_p - 0.02) << point.distance_m;
    EXPECT_LE(point.max_error_m, least_m * (1 + 1e-3)) << point.distance_m;
    most_p = std::max(most_p, point.p_within_limit);
    least_m = std::min(least_m, point.max_error_m);
  }
  EXPECT_NE(selection.notes[1].find("the worst is 0.00 km (leg 1): P = "), std::string::npos) << selection.notes[1];
}

TEST(LossAnywhere, OfEqualPointsTheFirstIsTheWorst) {
  Mission mission = straight_mission(600);
  mission.flight.denied.anywhere = true;
  mission.flight.max_error_m = 1000;
  const std::vector<TileScores> scores = random_scores(mission, 0.8, 0.9, "OfEqualPoints");
  const Selection selection = select_tiles(mission, scores, kStoredSize, {});
  const LossAnywhere& loss = *selection.loss_anywhere;
  for (const LossPoint& point : loss.points) EXPECT_NEAR(point.p_within_limit, 1, 1e-8);
  for (std::size_t i = 0; i < loss.worst; ++i) {
    EXPECT_LT(loss.points[i].max_error_m, loss.points[loss.worst].max_error_m);
  }
}

TEST(LossAnywhere, LongRoutesAreLookedAtInSteps) {
  const Mission mission = straight_mission(20000, 50, 3);
  const std::vector<std::size_t> samples = loss_samples(mission);
  std::size_t flown = 0;
  for (const std::size_t sample : samples) flown += mission.flight.samples.size() - sample;
  EXPECT_LE(flown, 2U * 60'000);
  EXPECT_GT(flown, 45'000U);
  EXPECT_EQ(samples.front(), 0U);
  for (std::size_t i = 1; i < mission.flight.samples.size(); ++i) {
    if (mission.flight.samples[i].leg == mission.flight.samples[i - 1].leg) continue;
    EXPECT_TRUE(std::binary_search(samples.begin(), samples.end(), i)) << i;
  }
}

TEST(LossAnywhere, SelectionFileKeepsIt) {
  Mission mission = straight_mission(600);
  mission.flight.denied.anywhere = true;
  const Selection selection = select_tiles(mission, random_scores(mission, 0.2, 0.8, "Keeps"), kStoredSize, {});
  const auto json = selection_to_json(selection);
  EXPECT_EQ(selection_to_json(selection_from_json(json, "s.json")).dump(), json.dump());
}

}  // namespace
}  // namespace pilotage
