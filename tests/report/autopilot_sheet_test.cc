#include "pilotage/report/autopilot_sheet.h"

#include <limits>
#include <sstream>

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/report/report.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using testing::report_with_gap;

/// One gap of so many seconds, fixes tried each 2 s and always made elsewhere, GNSS lost at the first point.
Report report_with_silence(double duration_s) {
  Report report = report_with_gap(0.018);
  report.gaps[0].gap.duration_s = duration_s;
  report.fix_interval_s = 2;
  report.fix_sigma_m = 2;
  report.denied.clear();
  for (ReportLeg& leg : report.legs) leg.status.p_fix = 0.99;
  return report;
}

/// Lines of a parameter file that are no comments.
std::vector<std::string> set_lines(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    if (!line.starts_with("#")) lines.push_back(line);
  }
  return lines;
}

TEST(AutopilotSheet, AGapCountsWithTheWaitForTheNextTry) {
  EXPECT_THAT(autopilot_warnings(report_with_silence(2.9), Autopilot::kPx4Multicopter), IsEmpty());
  EXPECT_THAT(autopilot_warnings(report_with_silence(3.1), Autopilot::kPx4Multicopter),
              ElementsAre(HasSubstr("5 s after the last fix (EKF2_NOAID_TOUT, at most 10 s), and flies its failsafe: "
                                    "one gap is longer, 5 s (1.1 km – 3.2 km, legs 2 to 4)")));
}

TEST(AutopilotSheet, EachAutopilotHasItsOwnPatience) {
  const Report report = report_with_silence(6);  // 8 s without a fix
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kPx4FixedWing),
              ElementsAre(HasSubstr("unless it measures airspeed")));
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kArducopter), ElementsAre(HasSubstr("EKF failsafe")));
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kArduplane), IsEmpty()) << "10 s with airspeed";
  EXPECT_THAT(autopilot_warnings(report_with_silence(9), Autopilot::kArduplane), ElementsAre(HasSubstr("11 s")));
}

TEST(AutopilotSheet, WhereGnssIsThereIsNoSilence) {
  Report report = report_with_silence(40);
  const RouteGap& gap = report.gaps[0].gap;
  report.denied = {{0, gap.from_distance_m}};
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kPx4Multicopter), IsEmpty());
  const double middle_m = (gap.from_distance_m + gap.to_distance_m) / 2;
  report.denied = {{0, middle_m}};
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kPx4Multicopter), ElementsAre(HasSubstr("longer, 22 s")));
  report.loss_anywhere.emplace();
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kPx4Multicopter), ElementsAre(HasSubstr("longer, 42 s")))
      << "it may be lost before the gap";
}

TEST(AutopilotSheet, TriesInARowWithoutAFixAreASilenceToo) {
  Report report = report_with_silence(1);
  ASSERT_THAT(autopilot_warnings(report, Autopilot::kPx4Multicopter), IsEmpty());
  report.legs[1].status.p_fix = 0.78;  // three tries in 5 s: 1.06 %
  report.legs[2].status.p_fix = 0.79;  // 0.93 %
  report.legs[3].status.p_fix = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kPx4Multicopter),
              ElementsAre(HasSubstr("3 tries in a row without a fix: more than 1 % of the times on leg 2 (modelled")));
  report.denied = {{0, report.legs[1].from_distance_m}};
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kPx4Multicopter), IsEmpty());
}

TEST(AutopilotSheet, BeyondTheMessagesLargestSigmaNothingIsSent) {
  Report report = report_with_silence(1);
  report.sigma_multiple = 3;
  report.gaps[0].gap.error_m = 299;
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kArduplane), IsEmpty());
  report.gaps[0].gap.error_m = 303;
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kArduplane), ElementsAre(HasSubstr("101 m at the end of")));
  EXPECT_THAT(autopilot_warnings(report, Autopilot::kPx4FixedWing), IsEmpty());
}

TEST(AutopilotSheet, ParametersOfPx4AreLinesOfQgroundcontrol) {
  Report report = report_with_silence(1);
  report.max_error_m = 60;
  report.sigma_multiple = 3;
  EXPECT_THAT(set_lines(autopilot_parameters(report, Autopilot::kPx4Multicopter)),
              ElementsAre("1\t1\tEKF2_AGP0_ID\t1\t6", "1\t1\tEKF2_AGP0_CTRL\t1\t6", "1\t1\tEKF2_AGP0_MODE\t0\t6",
                          "1\t1\tEKF2_AGP0_NOISE\t2.00\t9", "1\t1\tCOM_POS_FS_EPH\t20.0\t9"));
  report.denied = {{0, report.route_length_m}};
  report.gaps[0].gap.duration_s = 9;
  const auto lines = set_lines(autopilot_parameters(report, Autopilot::kPx4FixedWing));
  EXPECT_THAT(lines, ElementsAre("1\t1\tEKF2_AGP0_ID\t1\t6", "1\t1\tEKF2_AGP0_CTRL\t1\t6", "1\t1\tEKF2_AGP0_MODE\t1\t6",
                                 "1\t1\tEKF2_AGP0_NOISE\t2.00\t9", "1\t1\tEKF2_NOAID_TOUT\t10000000\t6"));
}

TEST(AutopilotSheet, ParametersOfArdupilotFuseNoVelocity) {
  Report report = report_with_silence(60);
  report.fix_sigma_m = 30;
  for (const Autopilot autopilot : {Autopilot::kArducopter, Autopilot::kArduplane}) {
    const std::string text = autopilot_parameters(report, autopilot);
    EXPECT_THAT(set_lines(text), ElementsAre("GPS2_TYPE,14", "GPS2_DELAY_MS,1", "EK3_SRC2_POSXY,3", "EK3_SRC2_VELXY,0",
                                             "EK3_SRC2_POSZ,1", "EK3_SRC2_VELZ,0", "EK3_SRC2_YAW,1",
                                             "EK3_SRC_OPTIONS,0", "EK3_GPS_CHECK,0", "EK3_POSNE_M_NSE,10.00"))
        << "at most what the parameter takes";
    EXPECT_THAT(text, HasSubstr("# WARNING: ArduPilot gives up a position"));
  }
}

TEST(AutopilotSheet, ATitleBeginsNoParameter) {
  Report report = report_with_silence(1);
  report.title = "route\nFS_EKF_ACTION,0";
  const std::string text = autopilot_parameters(report, Autopilot::kArduplane);
  EXPECT_THAT(set_lines(text), Not(::testing::Contains(HasSubstr("FS_EKF"))));
  EXPECT_THAT(text, HasSubstr("route FS_EKF_ACTION,0"));
}

TEST(AutopilotSheet, AReportOfAnAutopilotWarns) {
  ReportInput input = testing::report_scene({.matchable_from = 0.3, .matchable_to = 0.9});
  const std::size_t before = make_report(input).warnings.size();
  input.autopilot = Autopilot::kPx4Multicopter;
  const Report report = make_report(input);
  ASSERT_EQ(report.warnings.size(), before + 1);
  EXPECT_THAT(report.warnings.back(), HasSubstr("EKF2_NOAID_TOUT"));
}

}  // namespace
}  // namespace pilotage
