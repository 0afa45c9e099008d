#include "pilotage/verdict/quality.h"

#include <cmath>
#include <limits>

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/nan.h"
#include "pilotage/verdict/disagreement.h"
#include "pilotage/verdict/verdict.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// A plan that is good in every row, with one gap of 3.4 km at 28 m/s.
ReportInput plain_input(double gap_error_m, double limit_m) {
  ReportInput input;
  GridLevel level;
  level.gsd_m = 0.6;
  level.matrix.tile_size_px = 256;
  level.matrix.stride_px = 256;
  input.mission.ground.levels = {level};
  for (int i = 0; i < 4; ++i) {
    GroundTile tile;
    tile.tile_id = i;
    tile.valid_fraction = 1;
    input.mission.ground.tiles.push_back(tile);
    TileScores score;
    score.degraded.margin = 0.2;
    input.scores.push_back(score);
    input.selection.tile_ids.push_back(i);
  }
  input.mission.ground.imagery.datasets = {{"a.tif", 0.3, "EPSG:32632", "2024-06-01", 100, 100}};
  RouteGap gap;
  gap.leg = 2;
  gap.from_distance_m = 1000;
  gap.to_distance_m = 4416;
  gap.duration_s = 122;
  gap.error_m = gap_error_m;
  gap.within_limit = gap_error_m <= limit_m;
  input.selection.gaps = {gap};
  input.selection.error_profile = {{0, 3, true}, {4416, gap_error_m, false}};
  input.selection.matchable_fraction = 0.87;
  input.selection.max_error_m = limit_m;
  input.selection.within_limit = gap.within_limit;
  return input;
}

QualityRow row_named(const ReportInput& input, const std::string& name) {
  for (const QualityRow& row : quality_rows(judged_plan(input))) {
    if (row.name == name) return row;
  }
  throw std::out_of_range(name);
}

std::string sentence(const ReportInput& input) {
  const auto rows = quality_rows(judged_plan(input));
  return verdict_sentence(verdict_of(rows), rows, input.selection);
}

TEST(Verdict, NoGoSaysWhereAndWhy) {
  EXPECT_EQ(sentence(plain_input(61, 50)),
            "NO-GO: matchable on 87 % of its length; longest gap 3.4 km = 122 s at 28 m/s; drift there 61 m > 50 m");
}

TEST(Verdict, GoAndMarginal) {
  EXPECT_EQ(sentence(plain_input(31, 50)),
            "GO: matchable on 87 % of its length; longest gap 3.4 km = 122 s at 28 m/s; drift there 31 m ≤ 50 m");
  EXPECT_THAT(sentence(plain_input(45, 50)), StartsWith("MARGINAL: "));
  EXPECT_THAT(sentence(plain_input(40, 50)), StartsWith("GO: "));
  EXPECT_THAT(sentence(plain_input(50, 50)), StartsWith("MARGINAL: "));
}

TEST(Verdict, WithoutGapTheLargestErrorIsSaid) {
  ReportInput input = plain_input(12, 50);
  input.selection.gaps.clear();
  EXPECT_EQ(sentence(input), "GO: matchable on 87 % of its length; no gap; largest error 12 m ≤ 50 m");
}

TEST(Verdict, AWorseErrorElsewhereIsSaid) {
  ReportInput input = plain_input(31, 50);
  input.selection.legs.push_back({3, 100, 0.5, 70, false});
  EXPECT_THAT(sentence(input), StartsWith("NO-GO: "));
  EXPECT_THAT(sentence(input), HasSubstr("drift there 31 m ≤ 50 m; largest error 70 m > 50 m"));
}

TEST(Verdict, UnknownAndUnboundedErrorsAreNoGo) {
  EXPECT_THAT(sentence(plain_input(kNaN, 50)), HasSubstr("drift there unknown > 50 m"));
  EXPECT_THAT(sentence(plain_input(kNaN, 50)), StartsWith("NO-GO: "));
  EXPECT_THAT(sentence(plain_input(std::numeric_limits<double>::infinity(), 50)), HasSubstr("unbounded > 50 m"));
  ReportInput empty = plain_input(31, 50);
  empty.selection.gaps.clear();
  empty.selection.error_profile.clear();
  EXPECT_THAT(sentence(empty), StartsWith("NO-GO: "));
}

TEST(Verdict, TheSelectionsOwnFlagIsNotOverruled) {
  ReportInput input = plain_input(31, 50);
  input.selection.within_limit = false;
  EXPECT_THAT(sentence(input), StartsWith("NO-GO: "));
}

TEST(Verdict, WhatNobodyJudgedIsNoGo) {
  ReportInput input = plain_input(31, 50);
  input.selection.matchability_judged = false;
  EXPECT_THAT(sentence(input), StartsWith("NO-GO: "));
  EXPECT_THAT(sentence(input), HasSubstr("Whether the matcher finds the tiles: not judged"));
}

TEST(Verdict, DistortionAndAnEmptyMapEnterIt) {
  ReportInput input = plain_input(31, 50);
  input.mission.ground.max_scale_distortion = 0.002;
  EXPECT_THAT(sentence(input), StartsWith("MARGINAL: "));
  EXPECT_THAT(sentence(input), HasSubstr("Scale distortion of the mission grid: 0.200 %"));
  input.mission.ground.max_scale_distortion = 0.01;
  EXPECT_THAT(sentence(input), StartsWith("NO-GO: "));
  ReportInput empty = plain_input(31, 50);
  empty.selection.tile_ids.clear();
  EXPECT_THAT(sentence(empty), StartsWith("MARGINAL: "));
  EXPECT_THAT(sentence(empty), HasSubstr("0 of 4"));
}

TEST(Verdict, AdviceAloneDoesNotStopAFlight) {
  ReportInput input = plain_input(31, 50);
  input.selection.matchable_fraction = 0.12;  // a sparse map
  input.mission.ground.imagery.datasets.front().acquired = "";
  EXPECT_THAT(sentence(input), StartsWith("GO: matchable on 12 %"));
}

TEST(Verdict, TheProbabilityThatWasAskedForIsNeededForGo) {
  ReportInput input = plain_input(31, 50);
  input.selection.probability = RouteProbability{0.93, 0.9, 41.5, 0.0021, std::nullopt, {}};
  EXPECT_EQ(
      sentence(input),
      "GO: 93 of 100 flights stay within 50 m all the way, if what is assumed holds (P = 0.930 ≥ 0.900); matchable on "
      "87 % of its length; longest gap 3.4 km = 122 s at 28 m/s; drift there 31 m ≤ 50 m");
  input.selection.probability->p_within_limit = 0.89996;
  input.selection.probability->worst = WorstStretch{2, 1000, 4416, 0.08};
  EXPECT_THAT(sentence(input), StartsWith("NO-GO: "));
  EXPECT_THAT(sentence(input), StartsWith("NO-GO: 89 of 100 flights stay within 50 m all the way, even if what is "
                                          "assumed holds (P = 0.899 < 0.900); most are lost from 1.0 km to 4.4 km "
                                          "(leg 3), where fixes fail too often; matchable on 87 %"));
  EXPECT_THAT(sentence(input), HasSubstr("; if every fix came, drift there 31 m ≤ 50 m"))
      << "an error within the limit beside flights that are lost is explained";
  const QualityRow row = row_named(input, "route_probability");
  EXPECT_EQ(row.status, QualityStatus::kBad);
  EXPECT_THAT(row.advice, HasSubstr("between 1.0 km and 4.4 km, on leg 3"));
  input.selection.probability.reset();
  EXPECT_THROW(row_named(input, "route_probability"), std::out_of_range);
}

TEST(Headline, SaysNoMoreFlightsThanThereAre) {
  Selection selection;
  selection.max_error_m = 60;
  const auto said = [&](double p) {
    selection.probability = RouteProbability{p, 0.9, 1, 0, std::nullopt, {}};
    return headline({}, selection);
  };
  EXPECT_THAT(said(0.9579), StartsWith("95 of 100 flights stay within 60 m all the way, if what is assumed holds"));
  EXPECT_THAT(said(0.99999), StartsWith("99 of 100 flights stay"));
  EXPECT_THAT(said(1), StartsWith("100 of 100 flights stay"));
  EXPECT_THAT(said(0.29), StartsWith("29 of 100 flights stay within 60 m all the way, even if"));
  EXPECT_THAT(said(0.0199), StartsWith("1 of 100 flights stays"));
  EXPECT_THAT(said(0.0099), StartsWith("fewer than 1 of 100 flights stay"));
  EXPECT_THAT(said(0), StartsWith("fewer than 1 of 100 flights stay"));
  selection.probability.reset();
  selection.error_profile = {{0, 31, true}};
  EXPECT_EQ(headline({}, selection),
            "the error is predicted up to 31 m ≤ 60 m, if what is assumed holds and every fix comes; how often fixes "
            "come is not known");
}

std::string said_assumptions(const Flight& flight, const Selection& selection) {
  Mission mission;
  mission.flight = flight;
  return assumptions_line(mission, selection);
}

TEST(Assumptions, WhatWasNotGivenIsCalledDefault) {
  Flight flight;
  flight.max_error_m = 50;
  flight.max_error_assumed = true;
  Selection selection;
  selection.max_error_m = 50;
  EXPECT_EQ(said_assumptions(flight, selection),
            "assumes: tactical INS (default), GNSS lost at the first point, limit 50 m (default), map error 1 m on "
            "each axis");
  selection.max_error_m = 35;  // select --max-error-m
  flight.ins.grade = InsGrade::kTactical;
  EXPECT_EQ(said_assumptions(flight, selection),
            "assumes: tactical INS, GNSS lost at the first point, limit 35 m, map error 1 m on each axis");
  flight.ins.grade = InsGrade::kVisualOdometry;
  flight.flat_ground_amsl_m = 15;
  EXPECT_EQ(said_assumptions(flight, selection),
            "assumes: visual-odometry INS, GNSS lost at the first point, limit 35 m, map error 1 m on each axis, flat "
            "ground at home's height "
            "(default)");
}

TEST(Assumptions, SayWhereGnssIsDenied) {
  Flight flight;
  flight.samples.resize(2);
  flight.samples[1].distance_m = 9000;
  Selection selection;
  flight.denied.stretches = {{3200, 7500}};
  const std::string state = ", fixes taken where it is had, too";
  EXPECT_EQ(gnss_text(flight, selection),
            "GNSS denied from 3.2 km to 7.5 km, trusted at once where it comes back" + state);
  flight.denied.stretches = {{300, 700}, {3200, 9000}};
  EXPECT_EQ(gnss_text(flight, selection),
            "GNSS denied from 300 m to 700 m and from 3.2 km to 9.0 km, trusted at once where it comes back" + state);
  flight.denied.stretches = {{3200, 9000}};
  EXPECT_EQ(gnss_text(flight, selection), "GNSS denied from 3.2 km to 9.0 km" + state);
  flight.denied.stretches = {{0, 3200}};
  EXPECT_EQ(gnss_text(flight, selection),
            "GNSS denied from 0 m to 3.2 km, trusted at once where it comes back" + state);
  flight.denied.stretches = {{0, 9000}};
  EXPECT_EQ(gnss_text(flight, selection), "GNSS denied from 0 m to 9.0 km");
  flight.denied.stretches = {{0, 1000}, {2000, 3000}, {4000, 4500}, {5000, 6000}};
  EXPECT_EQ(gnss_text(flight, selection),
            "GNSS denied over 4 stretches, 3.5 km in all, the first from 0 m to 1.0 km, trusted at once where it comes "
            "back" +
                state);
  flight.denied = {};
  flight.denied.anywhere = true;
  selection.loss_anywhere = LossAnywhere{{{0, 0, 20, 0.9}, {3210, 1, 30, 0.8}}, 1, 3210};
  EXPECT_EQ(gnss_text(flight, selection), "GNSS lost for good at the worst point, 3.2 km (leg 2)" + state);
  selection.max_error_m = 50;
  EXPECT_THAT(said_assumptions(flight, selection),
              HasSubstr("the worst point, 3.2 km (leg 2)" + state + ", limit 50 m"));
}

Selection with_probability(double p_within_limit) {
  Selection selection;
  selection.max_error_m = 50;
  selection.probability = RouteProbability{p_within_limit, 0.9, 1, 0, WorstStretch{0, 0, 139, 1 - p_within_limit}, {}};
  return selection;
}

TEST(JudgeLeg, ProbabilityCountsBesideTheError) {
  const auto judged = [](double error_m, double p, const Selection& selection) {
    LegStatus leg;
    leg.max_error_m = error_m;
    leg.within_limit = error_m <= 50;
    leg.p_within_limit = p;
    return judge_leg(leg, selection);
  };
  const Selection known = with_probability(0.5);
  EXPECT_EQ(judged(10, 0.95, known), QualityStatus::kGood);
  EXPECT_EQ(judged(10, 0.949, known), QualityStatus::kMarginal);
  EXPECT_EQ(judged(10, 0.9, known), QualityStatus::kMarginal);
  EXPECT_EQ(judged(10, 0.899, known), QualityStatus::kBad);
  EXPECT_EQ(judged(10, 0, known), QualityStatus::kBad);
  EXPECT_EQ(judged(10, kNaN, known), QualityStatus::kBad) << "no flight reaches it within the limit";
  EXPECT_EQ(judged(45, 1, known), QualityStatus::kMarginal);
  EXPECT_EQ(judged(51, 1, known), QualityStatus::kBad);
  Selection unknown;
  unknown.max_error_m = 50;
  EXPECT_EQ(judged(10, kNaN, unknown), QualityStatus::kGood);
}

TEST(JudgeGap, WhereFlightsAreLostItIsBad) {
  RouteGap gap;
  gap.from_distance_m = 0;
  gap.to_distance_m = 119;
  gap.error_m = 39;
  gap.p_first_excess = 0;
  EXPECT_EQ(judge_gap(gap, with_probability(0)), QualityStatus::kBad) << "in the stretch that loses the flights";
  EXPECT_EQ(judge_gap(gap, with_probability(0.95)), QualityStatus::kGood);
  gap.from_distance_m = 200;
  gap.to_distance_m = 300;
  EXPECT_EQ(judge_gap(gap, with_probability(0)), QualityStatus::kGood);
  gap.p_first_excess = 0.07;
  EXPECT_EQ(judge_gap(gap, with_probability(0.92)), QualityStatus::kMarginal);
  gap.p_first_excess = 0.11;
  EXPECT_EQ(judge_gap(gap, with_probability(0.89)), QualityStatus::kBad);
}

TEST(Disagreement, BeyondTheBudgetItDecides) {
  ReportInput input = plain_input(20, 50);
  EXPECT_THROW(row_named(input, "georeference_disagreement"), std::out_of_range) << "without a second date no row";
  EXPECT_EQ(disagreement_warning(judged_plan(input)), "");
  input.scores[0].epoch.disagreement_m = 4;
  input.scores[1].epoch.disagreement_m = 5.9;
  EXPECT_EQ(row_named(input, "georeference_disagreement").status, QualityStatus::kGood) << "3 σ of a fix are 6 m";
  EXPECT_THAT(sentence(input), StartsWith("GO: "));
  EXPECT_EQ(disagreement_warning(judged_plan(input)), "");
  input.scores[1].epoch.disagreement_m = 27.3;
  EXPECT_EQ(row_named(input, "georeference_disagreement").status, QualityStatus::kMarginal);
  EXPECT_EQ(row_named(input, "georeference_disagreement").value,
            "up to 27 m, median 27 m; largest error with it 47 m ≤ 50 m");
  EXPECT_THAT(sentence(input), StartsWith("MARGINAL: "));
  EXPECT_THAT(disagreement_warning(judged_plan(input)),
              StartsWith("the second date lies up to 27 m (median 27 m) from the imagery"));
  input.scores[1].epoch.disagreement_m = 31;
  EXPECT_THAT(sentence(input), StartsWith("NO-GO: "));
  EXPECT_THAT(sentence(input), HasSubstr("largest error with it 51 m > 50 m"));
  input.selection.tile_ids = {0, 2, 3};
  EXPECT_THAT(sentence(input), StartsWith("GO: ")) << "only tiles that are stored count";
}

TEST(QualityRows, AllGoodWithoutAdvice) {
  for (const QualityRow& row : quality_rows(judged_plan(plain_input(31, 50)))) {
    EXPECT_EQ(row.status, QualityStatus::kGood) << row.name;
    EXPECT_EQ(row.advice, "") << row.name;
    EXPECT_NE(row.threshold, "") << row.name;
    EXPECT_THAT(row.value, Not(HasSubstr("nan"))) << row.name;
  }
}

TEST(QualityRows, ThresholdsAreWhereTheySay) {
  ReportInput input = plain_input(31, 50);
  input.mission.ground.tiles.front().valid_fraction = 0.8;  // mean 0.95
  EXPECT_EQ(row_named(input, "imagery_coverage").status, QualityStatus::kMarginal);
  EXPECT_EQ(row_named(input, "imagery_coverage").number, 0.95);
  input.mission.ground.tiles.front().valid_fraction = 0;  // mean 0.75
  EXPECT_EQ(row_named(input, "imagery_coverage").status, QualityStatus::kBad);
  input.mission.ground.levels.front().gsd_m = 0.2;
  EXPECT_THAT(row_named(input, "map_gsd").advice, HasSubstr("--gsd-m 0.5"));
  input.mission.ground.levels.front().gsd_m = 3;
  EXPECT_THAT(row_named(input, "map_gsd").advice, HasSubstr("finer imagery"));
  input.mission.ground.levels.front().matrix.tile_size_px = 128;
  EXPECT_EQ(row_named(input, "footprint_pixels").status, QualityStatus::kMarginal);
  input.mission.ground.levels.front().matrix.tile_size_px = 127;
  EXPECT_EQ(row_named(input, "footprint_pixels").status, QualityStatus::kBad);
}

TEST(QualityRows, TilesByStatus) {
  ReportInput input = plain_input(31, 50);
  input.scores[0].status = TileStatus::kFlat;
  input.scores[1].status = TileStatus::kTooLittleGround;
  input.scores[2].status = TileStatus::kFlat;
  const QualityRow row = row_named(input, "scored_tiles");
  EXPECT_EQ(row.value, "25 % (1 scored, 1 with too little ground, 2 flat)");
  EXPECT_EQ(row.status, QualityStatus::kBad);
}

TEST(QualityRows, AmbiguousTilesAreCountedAmongTheSelected) {
  ReportInput input = plain_input(31, 50);
  input.scores[0].degraded.margin = -0.1;
  input.scores[1].degraded.margin = -0.1;
  input.selection.tile_ids = {1, 2, 3};
  EXPECT_EQ(row_named(input, "ambiguous_tiles").value, "1 of 3");
  for (TileScores& score : input.scores) score.degraded.margin = kNaN;
  EXPECT_EQ(row_named(input, "ambiguous_tiles").value, "not judged");
}

TEST(QualityRows, NothingAtAllIsNotGood) {
  const auto rows = quality_rows(judged_plan(ReportInput{}));
  EXPECT_EQ(verdict_of(rows), QualityStatus::kBad);
  EXPECT_EQ(verdict_of({}), QualityStatus::kBad);
}

}  // namespace
}  // namespace pilotage
