#include "pilotage/report/map_ageing.h"

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/matchability/level_at_age.h"
#include "pilotage/report/report.h"
#include "pilotage/verdict/map_holds.h"

namespace pilotage {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Flown a year after its imagery, P as given on that day and 12 months later.
ReportInput aged_scene(double p_now, double p_later, std::optional<double> enough, std::optional<double> surely) {
  ReportInput input = testing::report_scene({});
  input.mission.ground.imagery.datasets.resize(1);
  input.mission.ground.imagery.datasets[0].acquired = "2025-06-01";
  input.mission.ground.flight_time = "2026-06-01";
  input.selection.probability.emplace();
  input.selection.probability->p_within_limit = p_now;
  input.selection.probability->min_p_within_limit = 0.9;
  input.selection.probability->interval = ProbabilityInterval{p_now - 0.04, p_now + 0.01};
  input.selection.ageing = RouteAgeing{
      {{12, p_now, {p_now - 0.04, p_now + 0.01}}, {24, p_later, {p_later - 0.04, p_later + 0.01}}}, enough, surely};
  for (TileScores& score : input.scores) {
    score.p_correct_fix = 0.4;
    score.level_sigma = 1;
    score.level_age_months = 12;
  }
  return input;
}

/// The indices of stored tiles under the route.
std::vector<std::size_t> stored_under_route(const ReportInput& input) {
  std::vector<std::size_t> indices;
  for (const std::int64_t id : input.selection.tile_ids) {
    const std::size_t i = tile_index(input.mission.ground, id, "test");
    const double half_width_m = input.mission.ground.tiles[i].bounds.width_m() / 2;
    if (input.mission.flight.places[i].offset_m <= half_width_m) indices.push_back(i);
  }
  return indices;
}

TEST(MapAgeing, SaysUntilWhen) {
  const ReportInput go = aged_scene(0.95, 0.89, 23.2, 13.1);
  const std::string sentence = ageing_sentence(go.mission, go.selection);
  EXPECT_THAT(sentence,
              HasSubstr("P is at least what was asked for (0.900) until about 2027-05, when the imagery is 23 months "
                        "old; the lower end of its interval until about 2026-07, when the imagery is 13"));
  EXPECT_THAT(sentence, HasSubstr(kAgeRule));
  const Report report = make_report(go);
  ASSERT_TRUE(report.ageing);
  EXPECT_EQ(report.ageing->enough_until, "2027-05-08");
  EXPECT_EQ(report.ageing->flights[1].day, "2027-06-01");
  EXPECT_EQ(report.ageing->flights[0].status, QualityStatus::kGood);
  EXPECT_EQ(report.ageing->flights[1].status, QualityStatus::kBad);
  EXPECT_THAT(ageing_html(report.ageing),
              AllOf(HasSubstr("2026-06-01<"), HasSubstr("2027-06<"), HasSubstr("NO-GO"), HasSubstr(">GO</td>")));
}

TEST(MapAgeing, SaysSoWhereItIsNotEnoughOrNeverEnds) {
  const ReportInput marginal = aged_scene(0.92, 0.89, 20, std::nullopt);
  EXPECT_THAT(ageing_sentence(marginal.mission, marginal.selection),
              HasSubstr("; the lower end of its interval is below it already"));
  const ReportInput lost = aged_scene(0.8, 0.7, 3.4, std::nullopt);
  EXPECT_THAT(
      ageing_sentence(lost.mission, lost.selection),
      AllOf(HasSubstr("P is below what was asked for (0.900) on the planned day; with imagery no older than 3.4 "
                      "months the stored tiles would be enough"),
            Not(HasSubstr("lower end"))));
  const ReportInput weeks = aged_scene(0.8, 0.7, 0.8, std::nullopt);
  EXPECT_THAT(ageing_sentence(weeks.mission, weeks.selection), HasSubstr("with imagery no older than 3 weeks"));
  const ReportInput never = aged_scene(0.8, 0.7, std::nullopt, std::nullopt);
  EXPECT_THAT(ageing_sentence(never.mission, never.selection), HasSubstr("however young the imagery"));
  const ReportInput long_lived = aged_scene(0.99, 0.985, kMostAge_months, kMostAge_months);
  EXPECT_THAT(ageing_sentence(long_lived.mission, long_lived.selection),
              HasSubstr("as far as anything is known, to imagery 170 months old"));
  ReportInput none = aged_scene(0.95, 0.9, 20, 20);
  none.selection.ageing.reset();
  EXPECT_EQ(ageing_sentence(none.mission, none.selection), "");
  EXPECT_FALSE(make_report(none).ageing);
  EXPECT_EQ(ageing_html(std::nullopt), "");
}

TEST(MapAgeing, ARowTellsHowLong) {
  const auto row_of = [](const ReportInput& input) { return *ageing_row(input.mission, input.selection); };
  const QualityRow good = row_of(aged_scene(0.95, 0.93, 30, 13));
  EXPECT_EQ(good.status, QualityStatus::kGood);
  EXPECT_DOUBLE_EQ(good.number, 18);
  EXPECT_FALSE(good.decides);
  EXPECT_EQ(row_of(aged_scene(0.95, 0.89, 15, 13)).status, QualityStatus::kMarginal);
  const QualityRow never = row_of(aged_scene(0.8, 0.7, std::nullopt, std::nullopt));
  EXPECT_EQ(never.status, QualityStatus::kMarginal);
  EXPECT_THAT(never.advice, Not(IsEmpty()));
}

TEST(MapAgeing, NamesTheTilesThatGoStaleFirst) {
  ReportInput input = aged_scene(0.95, 0.89, 23, 13);
  const std::vector<std::size_t> stored = stored_under_route(input);
  ASSERT_GT(stored.size(), 9u);
  for (const std::size_t i : stored) input.scores[i].p_correct_fix = 0.9;
  for (std::size_t n = 0; n < 8; ++n) input.scores[stored[n]].p_correct_fix = 0.545 - 0.01 * static_cast<double>(n);
  const Report report = make_report(input);
  ASSERT_EQ(report.ageing->refresh.size(), kMostStaleTiles);
  const auto id = [&](std::size_t n) { return input.mission.ground.tiles[stored[n]].tile_id; };
  EXPECT_EQ(report.ageing->refresh[0].tile_id, id(7)) << "the weakest of those below one half now";
  EXPECT_EQ(report.ageing->refresh[0].half_found_until, "");
  EXPECT_EQ(report.ageing->refresh[3].tile_id, id(4)) << "the first to fall below";
  EXPECT_EQ(report.ageing->refresh[3].half_found_until, report.tiles[stored[4]].half_found_until);
  EXPECT_EQ(report.ageing->flights[0].tiles_half_found, static_cast<std::int64_t>(stored.size()) - 3);
  EXPECT_EQ(report.ageing->flights[1].tiles_half_found, static_cast<std::int64_t>(stored.size()) - 8);
  EXPECT_THAT(ageing_html(report.ageing), HasSubstr("° (now), tile"));
}

TEST(MapAgeing, OfAFlightBeforeItsImageryTilesSayNothing) {
  ReportInput input = aged_scene(0.95, 0.89, 23, 13);
  input.selection.ageing.reset();
  input.mission.ground.flight_time = "2024-06-01";
  for (TileScores& score : input.scores) score.p_correct_fix = 0.9;
  EXPECT_EQ(make_report(input).tiles[stored_under_route(input).front()].half_found_until, "");
}

TEST(MapAgeing, RefusesASelectionOfAnotherPlan) {
  ReportInput input = aged_scene(0.95, 0.89, 23, 13);
  input.mission.ground.imagery.datasets[0].acquired = "";
  EXPECT_THROW(make_report(input), DataError);
}

}  // namespace
}  // namespace pilotage
