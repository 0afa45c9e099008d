#include "pilotage/report/simulated_flights.h"

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/verdict/evidence.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

Simulation flown(std::int64_t within, std::int64_t of) {
  Simulation simulation;
  simulation.flights = of;
  simulation.max_error_m = 50;
  simulation.planned_p = 0.95;
  simulation.within = {within, of};
  simulation.legs = {{0, 0.95, {within, of}}};
  for (int i = 1; i <= 3; ++i) {
    SimulatedMark mark;
    mark.distance_m = 200.0 * i;
    mark.p_within = i < 3 ? 1 : simulation.within.value();
    mark.lost = i < 3 ? 0 : of - within;
    mark.cep50_m = 2;
    mark.r95_m = i < 3 ? 9.5 : kNaN;
    mark.nees = 2.4;
    mark.nees_band = {1.8, 2.2};
    mark.true_place = {20, 8, 90};
    simulation.marks.push_back(mark);
  }
  simulation.not_simulated = {"<rain>"};
  return simulation;
}

Selection asking(double p) {
  Selection selection;
  RouteProbability route;
  route.p_within_limit = 0.95;
  route.min_p_within_limit = p;
  selection.probability = route;
  return selection;
}

TEST(SimulatedRow, JudgesByTheInterval) {
  EXPECT_EQ(simulated_row(flown(960, 1000), asking(0.9)).status, QualityStatus::kGood);
  const QualityRow few = simulated_row(flown(19, 20), asking(0.9));
  EXPECT_EQ(few.status, QualityStatus::kMarginal) << "19 of 20 do not show 0.9";
  EXPECT_THAT(few.advice, HasSubstr("fly more"));
  const QualityRow bad = simulated_row(flown(800, 1000), asking(0.9));
  EXPECT_EQ(bad.status, QualityStatus::kBad);
  EXPECT_TRUE(bad.decides);
  EXPECT_THAT(bad.advice, HasSubstr("Most flights are lost from 400 m to 600 m: 200 of 200 that are lost"));
  EXPECT_FALSE(simulated_row(flown(800, 1000), {}).decides) << "nothing was asked for";
}

TEST(SimulatedRow, OfferedAPlanThatIsGoTheVerdictIsNoGo) {
  ReportInput input = testing::report_scene({});
  input.selection.probability = asking(0.9).probability;
  EXPECT_NE(make_report(input).verdict, QualityStatus::kBad);
  input.simulations = {flown(800, 1000)};
  const Report report = make_report(input);
  EXPECT_EQ(report.verdict, QualityStatus::kBad);
  EXPECT_THAT(report.verdict_text, HasSubstr("Simulated flights that stay within the limit: 0.800 [0.773, 0.824]"));
}

TEST(SimulatedFlights, StandOnThePage) {
  ReportInput input = testing::report_scene({});
  const std::string without = report_html(input);
  EXPECT_THAT(without, Not(HasSubstr("simulation-heading")));
  EXPECT_THAT(without, Not(HasSubstr("show-true-places\"")));
  input.simulations = {flown(960, 1000)};
  const Report report = make_report(input);
  const std::string html = report_html(report);
  EXPECT_THAT(html,
              HasSubstr("Simulated flights that stay within the limit: 0.960 [0.945, 0.971], 960 of 1000 flights; "
                        "planned 0.950</li>"));
  EXPECT_THAT(html, HasSubstr("+0.010 [−0.004, +0.021]")) << "difference of the leg";
  EXPECT_THAT(html, HasSubstr("2.40 outside [1.80, 2.20]"));
  EXPECT_THAT(html, HasSubstr("&lt;rain&gt;"));
  EXPECT_THAT(html, Not(HasSubstr("<rain>")));
  EXPECT_THAT(html, HasSubstr("<path class=\"simulated-r95\" d=\"M"));
  EXPECT_THAT(html, HasSubstr("id=\"show-true-places\""));
  ASSERT_EQ(report.display.true_place_lines_m.size(), 3U);
  // 90°: the major axis lies east, on a page that stretches by 1 / cos(latitude).
  const auto& line = report.display.true_place_lines_m[0];
  const double half_turn = static_cast<double>(line.size() - 1) / 2;
  const Eigen::Vector2d across = line[0] - line[static_cast<std::size_t>(half_turn)];
  EXPECT_NEAR(across.x() * std::cos(51.96 * 3.141592653589793 / 180), 40, 0.5);
  EXPECT_NEAR(across.y(), 0, 0.5);
}

TEST(SimulatedFlights, NumbersSayWhatTheyRestOn) {
  const std::string html = report_html(testing::report_scene({}));
  for (const char* kind : {"measured", "simulated", "modelled"}) {
    EXPECT_THAT(html, HasSubstr("<span class=\"kind " + std::string(kind) + "\"")) << kind;
  }
  std::map<std::string, NumberKind> kinds;
  for (const QualityRow& row : quality_rows(judged_plan(testing::report_scene({})))) kinds[row.name] = row.kind;
  EXPECT_EQ(kinds.at("largest_error"), NumberKind::kModelled);
  EXPECT_EQ(kinds.at("imagery_coverage"), NumberKind::kMeasured);
  EXPECT_EQ(kinds.at("ambiguous_tiles"), NumberKind::kSimulated);
  EXPECT_EQ(kinds.at("map_gsd"), NumberKind::kStated);
}

TEST(SimulatedFlights, OfAnotherPlanAreRefused) {
  Simulation simulation = flown(9, 10);
  simulation.inputs = {{"plan", "", "", "blake2b-256:aa"}, {"table", "", "", "blake2b-256:bb"}};
  ReportInput input;
  add_simulation(input, simulation, "s.json", {{"plan", "p.json", "", "blake2b-256:aa"}});
  try {
    ReportInput other;
    add_simulation(other, simulation, "s.json", {{"table", "t.csv", "", "blake2b-256:cc"}});
    FAIL();
  } catch (const DataError& error) {
    EXPECT_STREQ(error.what(), "s.json: was simulated with another table than t.csv; run `pilotage simulate` again");
  }
  try {
    add_simulation(input, simulation, "again.json", {});
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("again.json: is the second simulation with drawn fixes"));
  }
}

}  // namespace
}  // namespace pilotage
