#include "pilotage/report/key_figures.h"

#include <algorithm>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/report/report.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

/// The figure of a label; an empty one when there is none.
KeyFigure figure_of(const Report& report, const std::string& label) {
  const std::vector<KeyFigure> figures = key_figures(report);
  const auto found =
      std::find_if(figures.begin(), figures.end(), [&](const KeyFigure& figure) { return figure.label == label; });
  return found == figures.end() ? KeyFigure{} : *found;
}

Report known_report() {
  Report report;
  report.max_error_m = 60;
  report.largest_error_m = 26.4;
  report.matchable_fraction = 0.874;
  report.route_length_m = 6700;
  RouteProbability route;
  route.p_within_limit = 0.9404;
  route.min_p_within_limit = 0.9;
  route.interval = ProbabilityInterval{0.866, 0.985};
  report.probability = route;
  return report;
}

TEST(KeyFigures, SayTheNumberAndWhatBelongsToIt) {
  Report report = known_report();
  ReportGap gap;
  gap.gap.duration_s = 35;
  gap.gap.error_m = 26.4;
  gap.length_m = 635;
  report.gaps = {gap, gap};
  report.gaps.front().length_m = 120;
  EXPECT_EQ(figure_of(report, "P within 60 m").value, "0.940");
  EXPECT_EQ(figure_of(report, "P within 60 m").detail, "80 % interval 0.866 … 0.985; asked for: 0.900");
  EXPECT_EQ(figure_of(report, "P within 60 m").kind, NumberKind::kModelled);
  EXPECT_EQ(figure_of(report, "Longest gap").value, "635 m");
  EXPECT_EQ(figure_of(report, "Longest gap").detail, "35 s; drift there 26 m");
  EXPECT_EQ(figure_of(report, "Largest error").value, "26 m");
  EXPECT_EQ(figure_of(report, "Matchable").value, "87 %");
  EXPECT_EQ(figure_of(report, "Onboard map").value, "") << "nothing is known of its size";
}

TEST(KeyFigures, SimulatedFlightsAreToldApartAndMissed) {
  Report report = known_report();
  EXPECT_EQ(figure_of(report, "Simulated flights").value, "none");
  Simulation drawn;
  drawn.within = {1865, 2000};
  Simulation rendered;
  rendered.within = {9, 10};
  rendered.rendered = {{"world", "later.tif"}};
  report.simulations = {drawn, rendered};
  EXPECT_EQ(figure_of(report, "Simulated flights").value, "");
  EXPECT_EQ(figure_of(report, "Simulated flights within it").value, "0.932");
  EXPECT_THAT(figure_of(report, "Simulated flights within it").detail, HasSubstr("1865 of 2000, 95 % interval 0.920"));
  EXPECT_EQ(figure_of(report, "Flights by rendered frames").value, "0.900");
}

TEST(KeyFigures, WhatIsNotKnownIsLeftOut) {
  Report report = known_report();
  report.probability.reset();
  report.largest_error_m = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(figure_of(report, "P within 60 m").value, "");
  EXPECT_EQ(figure_of(report, "Largest error").value, "");
  EXPECT_EQ(figure_of(report, "Longest gap").value, "none");
}

}  // namespace
}  // namespace pilotage
