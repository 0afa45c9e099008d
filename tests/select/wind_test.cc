#include <cmath>
#include <numeric>
#include <stdexcept>

#include "select/straight_mission.h"
#include <gtest/gtest.h>

#include "pilotage/mission/chances_beside_line.h"
#include "pilotage/mission/wind_cases.h"
#include "pilotage/select/flown_steps.h"
#include "pilotage/select/route_probability.h"

namespace pilotage {
namespace {

using testing::straight_mission;

TEST(GroundSpeed, IsTheWindTriangle) {
  EXPECT_DOUBLE_EQ(ground_speed_mps(20, 0, {0, 0}), 20);
  EXPECT_DOUBLE_EQ(ground_speed_mps(20, 0, {0, -5}), 15) << "flying north against a wind that blows to the south";
  EXPECT_DOUBLE_EQ(ground_speed_mps(20, 90, {5, 0}), 25);
  EXPECT_NEAR(ground_speed_mps(13, 0, {5, 0}), 12, 1e-12) << "crabbing";
  EXPECT_NEAR(ground_speed_mps(20, 0, {0, -30}), 6, 1e-12) << "no one flies on more slowly";
}

TEST(WindNodes, HaveTheMomentsOfTheDistribution) {
  EXPECT_EQ(wind_nodes(0, 11, 0.3).size(), 1U);
  for (const std::size_t count : {std::size_t{3}, std::size_t{5}, std::size_t{8}, std::size_t{11}}) {
    double weights = 0;
    double squares = 0;
    Eigen::Vector2d mean(0, 0);
    constexpr int kShifts = 100;
    for (int k = 0; k < kShifts; ++k) {
      const std::vector<WindNode> nodes = wind_nodes(3, count, k / static_cast<double>(kShifts));
      EXPECT_EQ(nodes.size(), count);
      for (const WindNode& node : nodes) {
        weights += node.weight / kShifts;
        mean += node.weight / kShifts * node.wind_mps;
        squares += node.weight / kShifts * node.wind_mps.squaredNorm();
      }
    }
    EXPECT_NEAR(weights, 1, 1e-9) << count;
    EXPECT_LT(mean.norm(), 0.05) << count;
    // Few nodes leave out the strongest winds.
    EXPECT_NEAR(squares, 18, count > 3 ? 2.2 : 5) << count << ": two axes of 9";
  }
}

TEST(WindCases, EachLevelHasTheWholeWeight) {
  const std::vector<WindCase> cases = wind_cases(3, 9);
  EXPECT_EQ(cases.size(), 60U);
  std::vector<double> weights(9, 0.0);
  for (const WindCase& one : cases) weights[one.level] += one.node.weight;
  for (const double weight : weights) EXPECT_NEAR(weight, 1, 1e-12);
  EXPECT_EQ(wind_cases(3, 1).size(), 33U);
  EXPECT_EQ(wind_cases(0, 9).size(), 9U);
  EXPECT_EQ(wind_cases(0, 1).size(), 1U);
  EXPECT_THROW(wind_cases(3, 4), std::invalid_argument);
}

TEST(FlownSteps, AreSharedAlongALegAndLastLongerAgainstTheWind) {
  const Mission mission = straight_mission(2000, 50, 2);
  const InsErrorModel model = make_error_model(mission.flight.ins, mission.flight.conditions);
  const FlownSteps calm(mission.flight, {0, 0}, model);
  const FlownSteps against(mission.flight, {-10, 0}, model);
  ASSERT_EQ(calm.size() + 1, mission.flight.samples.size());
  EXPECT_LE(calm.distinct().size(), 4U);
  EXPECT_NEAR(calm[0].dt_s, 0.5, 1e-12);
  EXPECT_NEAR(against[0].dt_s, 1, 1e-12);
}

TEST(FlownSteps, LookAheadAsPropagationDoes) {
  const Mission mission = straight_mission(500);
  for (const double aid_mps : {0.0, 1.0}) {
    InsOptions ins;
    ins.grade = InsGrade::kIndustrial;
    if (aid_mps > 0) ins.velocity_aid_sigma_mps = aid_mps;
    const InsErrorModel model = make_error_model(ins, {});
    const FlownSteps steps(mission.flight, {3, 4}, model, 47);
    InsState state = update_with_fix(propagate(initial_ins_state(model, 90, 20), 30, 90, 20, model), 2);
    state = propagate(state, steps[0]);
    const InsState* const only = &state;
    const InsState later = propagate(state, 47, steps[0].heading_deg, steps[0].speed_mps, model);
    EXPECT_NEAR(steps.errors_ahead_m(1, InsSpan(state), {&only, 1}, 3).front(), position_error_m(later, 3),
                1e-9 * position_error_m(later, 3));
  }
}

// A tile that is found half the time every 400 m, held for some 900 m.
double p_in(const FlightConditions& conditions, double limit_m) {
  Mission mission = straight_mission(4000);
  mission.flight.conditions = conditions;
  std::vector<double> p(mission.flight.samples.size(), 0.0);
  for (std::size_t i = 20; i < p.size(); i += 40) p[i] = 0.7;
  RouteChances chances{p, std::vector<std::int64_t>(p.size()), 0, 0.001, {}};
  std::iota(chances.window.begin(), chances.window.end(), 0);
  return predict_survival(make_flight_path(mission, limit_m), chances).p_within_limit.back();
}

TEST(RouteProbability, WindAnErrorOfTheMapAndDroppedFramesCost) {
  const double limit_m = testing::error_after_s(straight_mission(100), 60);
  const double calm = p_in({0, 0, 300, 0}, limit_m);
  EXPECT_GT(calm, 0.3);
  EXPECT_LT(p_in({6, 0, 300, 0}, limit_m), calm - 0.02);
  EXPECT_LT(p_in({0, 5, 300, 0}, limit_m), calm - 0.02);
  EXPECT_LT(p_in({0, 0, 300, 0.2}, limit_m), calm - 0.02);
}

TEST(RouteProbability, AMapsErrorIsNoLessForMoreFixes) {
  InsErrorModel model = make_error_model({}, {0, 4, 1e6, 0});
  InsState state = initial_ins_state(model, 0, 20);
  for (int i = 0; i < 50; ++i) state = update_with_fix(propagate(state, 1, 0, 20, model), 1);
  // GNSS knew the place to 3 m: one part in three of it is known beside the map.
  EXPECT_GT(position_error_m(state, 1), 2.2);
  model.map_sigma_m = 0;
  state = initial_ins_state(model, 0, 20);
  for (int i = 0; i < 50; ++i) state = update_with_fix(propagate(state, 1, 0, 20, model), 1);
  EXPECT_LT(position_error_m(state, 1), 1);
}

TEST(ChancesBesideLine, FallWhereTheTilesEnd) {
  const Mission wide = straight_mission(2000, 400);
  const ChancesBesideLine everywhere =
      chances_beside_line(wide, wide.flight.samples[100], std::vector<double>(wide.ground.tiles.size(), 0.6));
  EXPECT_NEAR(everywhere.shares[2], 1, 1e-12);
  const Mission strip = straight_mission(2000, 20);
  const ChancesBesideLine beside =
      chances_beside_line(strip, strip.flight.samples[100], std::vector<double>(strip.ground.tiles.size(), 0.6));
  EXPECT_EQ(beside.step_m, 50);
  // A strip of 25 m to each side; the line stands in its middle: Φ(25 / σ) − Φ(−25 / σ).
  EXPECT_NEAR(beside.shares[0], 0.954, 0.06);
  EXPECT_NEAR(beside.shares[1], 0.683, 0.09);
  EXPECT_NEAR(beside.shares[2], 0.383, 0.09);
  EXPECT_EQ(beside.share_at(0), 1);
  EXPECT_NEAR(beside.share_at(6.25), (1 + beside.shares[0]) / 2, 1e-12);
  EXPECT_NEAR(beside.share_at(37.5), (beside.shares[1] + beside.shares[2]) / 2, 1e-12);
  EXPECT_EQ(beside.share_at(900), beside.shares[2]);
  EXPECT_EQ(chances_beside_line(strip, strip.flight.samples[100], std::vector<double>(strip.ground.tiles.size(), 0.0))
                .share_at(50),
            1)
      << "no tile below, no try";
}

}  // namespace
}  // namespace pilotage
