#include "pilotage/verdict/evidence.h"

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/report/explain.h"
#include "pilotage/report/report.h"
#include "pilotage/report/simulated_flights.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

/// A plan of P 0.97 that asks for 0.9 and knows it to lie above `low` at nine places of ten.
ReportInput planned(double low = 0.93) {
  ReportInput input = testing::report_scene({});
  RouteProbability route;
  route.p_within_limit = 0.97;
  route.min_p_within_limit = 0.9;
  route.interval = ProbabilityInterval{low, 0.99};
  input.selection.probability = route;
  input.selection.tries.emplace();
  return input;
}

Simulation simulated(std::int64_t within, std::int64_t of, const std::string& world = "") {
  Simulation simulation;
  simulation.flights = of;
  simulation.max_error_m = 50;
  simulation.planned_p = 0.97;
  simulation.within = {within, of};
  if (!world.empty()) simulation.rendered = {{"world", world}};
  return simulation;
}

/// 200 tries of which `fixes` gave one, where 0.8 were predicted.
ReplayNote replayed(std::int64_t fixes, double z, double z_with_level, std::int64_t false_taken = 0) {
  ReplayNote note;
  note.file = "replay.json";
  note.flown = FlownAgainstPlan{.tries = 200,
                                .fixes = fixes,
                                .predicted = 0.8,
                                .z = z,
                                .z_with_level = z_with_level,
                                .without_right = 200 - fixes,
                                .false_taken = false_taken};
  return note;
}

TEST(RouteProbability, IsMarginalWhereOnlyTheLowerEndOfItsIntervalMisses) {
  EXPECT_EQ(make_report(planned()).verdict, QualityStatus::kGood);
  const Report report = make_report(planned(0.85));
  EXPECT_EQ(report.verdict, QualityStatus::kMarginal);
  EXPECT_THAT(report.verdict_text, HasSubstr("; P is below what is asked for at the lower end of its 80 % interval"));
  ReportInput low = planned(0.7);
  low.selection.probability->p_within_limit = 0.89;
  EXPECT_EQ(make_report(low).verdict, QualityStatus::kBad);
}

TEST(Evidence, IsReadFromTheStrongestDown) {
  ReportInput input = planned();
  input.simulations = {simulated(1960, 2000), simulated(19, 20, "later.tif")};
  input.replay = replayed(158, -0.3, -0.1);
  const Report report = make_report(input);
  std::vector<std::string> names;
  for (const QualityRow* row : evidence_rows(report.quality)) names.push_back(row->name);
  EXPECT_THAT(names, ElementsAre("flown_flights", "rendered_flights", "simulated_flights", "route_probability"));
  EXPECT_EQ(report.verdict, QualityStatus::kGood) << report.verdict_text;
  EXPECT_EQ(contradiction(report.quality), nullptr);
  EXPECT_EQ(missing_evidence(report.quality), "");
  EXPECT_THAT(evidence_line(report.quality),
              HasSubstr("rendered 0.950 [0.751, 0.998], 19 of 20 flights; planned 0.970; "
                        "frames of later.tif (good)"));
}

TEST(Evidence, ThatIsNotThereIsSaid) {
  const std::vector<QualityRow> rows = quality_rows(judged_plan(planned()));
  EXPECT_EQ(missing_evidence(rows), "not there: flown flights, frames of another date, drawn flights");
  const std::vector<std::string> lines = evidence_lines(rows);
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_THAT(lines[1], StartsWith("rendered: none; `pilotage simulate --fixes rendered"));
  EXPECT_THAT(lines[3], StartsWith("modelled: 0.970 ≥ 0.900"));
}

// Few flights by frames bound little: 9 of 10 are no contradiction to 0.9, 5 of 10 are.
TEST(Evidence, OfFewFramesEndsAGoOnlyWhereItContradicts) {
  ReportInput input = planned();
  input.simulations = {simulated(1960, 2000), simulated(9, 10, "later.tif")};
  EXPECT_EQ(make_report(input).verdict, QualityStatus::kGood);
  input.simulations[1] = simulated(8, 10, "later.tif");
  EXPECT_EQ(make_report(input).verdict, QualityStatus::kMarginal);
  input.simulations[1] = simulated(5, 10, "later.tif");
  const Report report = make_report(input);
  EXPECT_EQ(report.verdict, QualityStatus::kBad);
  EXPECT_THAT(
      report.verdict_text,
      StartsWith("NO-GO: the plan is contradicted: Flights by computed frames that stay within the limit: 0.500 "
                 "[0.187, 0.812], 5 of 10 flights; planned 0.970; frames of later.tif; by the model alone 97 of "
                 "100 flights stay within 50 m"));
  EXPECT_THAT(report_html(report), HasSubstr("The plan is contradicted"));
  input.selection.probability->p_within_limit = 0.85;
  input.simulations = {simulated(1700, 2000), simulated(5, 10, "later.tif")};
  const Report agreed = make_report(input);
  EXPECT_EQ(contradiction(agreed.quality), nullptr) << "all say no";
  EXPECT_THAT(agreed.verdict_text, StartsWith("NO-GO: 85 of 100 flights stay"));
  EXPECT_THAT(agreed.verdict_text, HasSubstr("; Flights by computed frames that stay within the limit: 0.500"));
}

TEST(Evidence, ThatIsFlownCountsMost) {
  ReportInput input = planned();
  input.simulations = {simulated(1960, 2000), simulated(20, 20, "later.tif")};
  input.replay = replayed(60, -9.5, -3.4);
  const Report report = make_report(input);
  EXPECT_EQ(report.verdict, QualityStatus::kBad);
  ASSERT_NE(contradiction(report.quality), nullptr);
  EXPECT_EQ(contradiction(report.quality)->name, "flown_flights");
  EXPECT_THAT(report.verdict_text, HasSubstr("60 of 200 tries; predicted 0.800: −3.4 σ with the level of the place, "
                                             "−9.5 σ were tries independent"));
  const std::vector<std::string> why = explain(report, {}, "verdict");
  EXPECT_THAT(why[0], StartsWith("NO-GO is the lowest of what decides"));
  EXPECT_THAT(why[1], HasSubstr("flown: 0.300"));
  EXPECT_THAT(why.back(), HasSubstr("refit P with what was flown"));
}

TEST(FlownRow, JudgesByTheLevelAndByIndependentTries) {
  const Selection selection = planned().selection;
  const auto status = [&](double z, double with_level) {
    return flown_row(*replayed(100, z, with_level).flown, selection).status;
  };
  EXPECT_EQ(status(-2.9, -1.9), QualityStatus::kGood);
  EXPECT_EQ(status(-2.9, -2.1), QualityStatus::kMarginal);
  EXPECT_EQ(status(-9.5, -1.2), QualityStatus::kMarginal) << "the place is worse than its mean";
  EXPECT_EQ(status(-9.5, -3.1), QualityStatus::kBad);
  EXPECT_EQ(status(9.5, 3.1), QualityStatus::kGood) << "more fixes than predicted lose no aircraft";
}

TEST(FlownRow, MoreFalseFixesThanReckonedWithAreMarginal) {
  const Selection selection = planned().selection;  // 0.001
  EXPECT_EQ(flown_row(*replayed(160, 0, 0, 1).flown, selection).status, QualityStatus::kGood)
      << "one of 40 shows no more than 0.0006";
  const QualityRow row = flown_row(*replayed(160, 0, 0, 4).flown, selection);
  EXPECT_EQ(row.status, QualityStatus::kMarginal);
  EXPECT_THAT(row.value, HasSubstr("false 0.100 [0.027, 0.236] of tries without a right fix, 0.001 reckoned with"));
}

TEST(JudgedPlan, TakesWhatIsKnownOfItAndNothingOfAPage) {
  const Mission mission;
  const std::vector<TileScores> scores;
  Selection selection;
  selection.probability.emplace().p_within_limit = 0.97;
  selection.probability->min_p_within_limit = 0.9;
  const auto names = [](const std::vector<QualityRow>& rows) {
    std::vector<std::string> kinds;
    for (const QualityRow* row : evidence_rows(rows)) kinds.push_back(row->name);
    return kinds;
  };
  EXPECT_THAT(names(quality_rows({mission, scores, selection})), ElementsAre("route_probability"));
  const std::vector<Simulation> simulations = {simulated(95, 100), simulated(19, 20, "later.tif")};
  const FlownAgainstPlan flown{.tries = 10, .fixes = 9, .predicted = 0.9};
  EXPECT_THAT(names(quality_rows({mission, scores, selection, simulations, &flown})),
              ElementsAre("flown_flights", "rendered_flights", "simulated_flights", "route_probability"));
}

}  // namespace
}  // namespace pilotage
