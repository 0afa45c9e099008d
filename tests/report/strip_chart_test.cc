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
  EXPECT_THAT(svg, HasSubstr("class=\"gap over\""));
  EXPECT_THAT(svg, HasSubstr("class=\"leg good\""));
  EXPECT_THAT(svg, HasSubstr("class=\"leg bad\""));
  EXPECT_THAT(svg, HasSubstr("class=\"fixes\""));
  EXPECT_THAT(svg, HasSubstr("Distance along the route (km)"));
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
