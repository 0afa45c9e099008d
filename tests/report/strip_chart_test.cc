#include "pilotage/report/strip_chart.h"

#include <limits>

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(TickStep, IsOneTwoOrFiveTimesAPowerOfTen) {
  EXPECT_DOUBLE_EQ(tick_step(66, 5), 20);
  EXPECT_DOUBLE_EQ(tick_step(3.6, 12), 0.5);
  EXPECT_DOUBLE_EQ(tick_step(200, 12), 20);
  EXPECT_DOUBLE_EQ(tick_step(100, 10), 10);
  EXPECT_DOUBLE_EQ(tick_step(0, 10), 1);
  EXPECT_DOUBLE_EQ(tick_step(std::numeric_limits<double>::infinity(), 10), 1);
}

TEST(StripChart, ShowsLimitGapLegsAndFixes) {
  testing::ReportSceneOptions options;
  options.matchable_from = 0.3;
  options.matchable_to = 0.9;
  options.drift = 0.03;
  const std::string svg = strip_chart_svg(make_report(testing::report_scene(options)));
  EXPECT_THAT(svg, HasSubstr("limit 50 m"));
  EXPECT_THAT(svg, HasSubstr("class=\"gap bad\""));
  EXPECT_THAT(svg, HasSubstr("class=\"leg good\""));
  EXPECT_THAT(svg, HasSubstr("class=\"leg bad\""));
  EXPECT_THAT(svg, HasSubstr("class=\"fixes\""));
  EXPECT_THAT(svg, HasSubstr("Distance along the route (km)"));
  EXPECT_THAT(svg, HasSubstr("class=\"hatch\"")) << "over the limit by more than colour";
  EXPECT_THAT(svg, HasSubstr(">✕ 2.2 km</text>"));
  options.drift = 0.01;
  const std::string good = strip_chart_svg(make_report(testing::report_scene(options)));
  EXPECT_THAT(good, Not(HasSubstr("class=\"hatch\"")));
  EXPECT_THAT(good, HasSubstr(">2.2 km</text>"));
}

TEST(StripChart, ProbabilitiesAreARibbonInTheColoursOfTheirHeatMap) {
  Report report;
  report.max_error_m = 50;
  report.route_length_m = 100;
  report.error_profile = {{0, 1, true, 0.001}, {25, 1, true, 0.002}, {50, 1, true, 0.999}, {100, 1, true, 1}};
  const std::string svg = strip_chart_svg(report);
  EXPECT_THAT(svg, HasSubstr(">P(fix)</text>"));
  const auto colors = color_table(ColorMap::kBlues);
  // One rectangle for each stretch of one shade, 64 … 624 … 1184 of the chart's units.
  EXPECT_THAT(svg, HasSubstr("<rect x=\"64\" y=\"276\" width=\"560\" height=\"12\" fill=\"" + hex_color(colors[0])));
  EXPECT_THAT(svg, HasSubstr("<rect x=\"624\" y=\"276\" width=\"560\" height=\"12\" fill=\"" + hex_color(colors[255])));
  for (ErrorSample& sample : report.error_profile) sample.p_correct_fix = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(strip_chart_svg(report), Not(HasSubstr("P(fix)")));
}

TEST(StripChart, UnboundedAndUnknownErrorsAreDrawnAtTheTop) {
  Report report;
  report.max_error_m = 50;
  report.route_length_m = 100;
  report.error_profile = {{0, 1, true},
                          {50, std::numeric_limits<double>::infinity(), false},
                          {100, std::numeric_limits<double>::quiet_NaN(), false}};
  const std::string svg = strip_chart_svg(report);
  EXPECT_THAT(svg, Not(HasSubstr("nan")));
  EXPECT_THAT(svg, Not(HasSubstr("inf")));
  EXPECT_THAT(svg, HasSubstr("L624 16L1184 16"));
}

TEST(StripChart, WithoutAPredictionItSaysSo) {
  EXPECT_THAT(strip_chart_svg(Report{}), HasSubstr("No prediction"));
}

}  // namespace
}  // namespace pilotage
