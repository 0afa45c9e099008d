#include "pilotage/report/autopilot_sheet.h"

#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>
#include <utility>

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/report/report.h"

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// A flight over matchable ground whose frames are always recognised, tried each 2 s, but for one gap of so many
/// seconds; GNSS is lost at the first point.
ReportInput input_with_gap(double gap_s) {
  ReportInput input = testing::report_scene({.matchable_from = 0.3, .matchable_to = 0.9});
  input.selection.tries.emplace().interval_s = 2;
  input.mission.flight.denied = {};
  input.mission.flight.ins.fix_sigma_m = 1.2;
  input.mission.flight.conditions.map_sigma_m = 1.6;
  double gap_m = 0;
  std::vector<FlightSample>& samples = input.mission.flight.samples;
  for (FlightSample& sample : samples) sample.speed_mps = 20;
  const std::vector<ErrorSample>& profile = input.selection.error_profile;
  std::vector<std::size_t> in_gap;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    if (profile[i].matchable && profile[i + 1].matchable) continue;
    gap_m += profile[i + 1].distance_m - profile[i].distance_m;
    in_gap.insert(in_gap.end(), {i, i + 1});
  }
  for (const std::size_t i : in_gap) samples[i].speed_mps = gap_m / gap_s;
  for (ErrorSample& sample : input.selection.error_profile) sample.p_correct_fix = sample.matchable ? 0.99 : 0;
  return input;
}

std::vector<std::string> warnings_of(const ReportInput& input, Autopilot autopilot) {
  return autopilot_warnings(input, make_report(input), autopilot);
}

std::string parameters_of(const ReportInput& input, Autopilot autopilot) {
  return autopilot_parameters(input, make_report(input), autopilot);
}

/// First and last place along the route without matchable ground.
std::pair<double, double> gap_of(const ReportInput& input) {
  const RouteGap& gap = input.selection.gaps.at(0);
  return {gap.from_distance_m, gap.to_distance_m};
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
  EXPECT_THAT(warnings_of(input_with_gap(2.9), Autopilot::kPx4Multicopter), IsEmpty());
  EXPECT_THAT(warnings_of(input_with_gap(3.1), Autopilot::kPx4Multicopter),
              ElementsAre(HasSubstr("5 s after the last fix (EKF2_NOAID_TOUT, at most 10 s), and flies its failsafe: "
                                    "one stretch is longer, 5 s (1.1 km – 3.2 km, legs 2 to 4)")));
}

TEST(AutopilotSheet, EachAutopilotHasItsOwnPatience) {
  const ReportInput input = input_with_gap(4.5);  // 6.5 s without a fix
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4FixedWing), ElementsAre(HasSubstr("unless it measures airspeed")));
  EXPECT_THAT(warnings_of(input, Autopilot::kArducopter), IsEmpty());
  EXPECT_THAT(warnings_of(input_with_gap(6), Autopilot::kArducopter), ElementsAre(HasSubstr("EKF failsafe")));
  EXPECT_THAT(warnings_of(input_with_gap(6), Autopilot::kArduplane), ElementsAre(HasSubstr("(10 s with airspeed)")));
}

TEST(AutopilotSheet, WhereGnssIsThereIsNoSilence) {
  ReportInput input = input_with_gap(40);
  const auto [from_m, to_m] = gap_of(input);
  input.mission.flight.denied.stretches = {{0, from_m}};
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4Multicopter), IsEmpty());
  input.mission.flight.denied.stretches = {{0, (from_m + to_m) / 2}};
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4Multicopter), ElementsAre(HasSubstr("longer, 20 s")))
      << "GNSS comes back: nobody waits for a try";
  input.mission.flight.denied.stretches = {{(from_m + to_m) / 2, to_m + 100}};
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4Multicopter), ElementsAre(HasSubstr("longer, 22 s")));
  input.mission.flight.denied = {};
  input.mission.flight.denied.anywhere = true;
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4Multicopter), ElementsAre(HasSubstr("longer, 42 s")))
      << "it may be lost before the gap";
}

TEST(AutopilotSheet, TriesInARowWithoutAFixAreASilenceToo) {
  ReportInput input = input_with_gap(1);
  ASSERT_THAT(warnings_of(input, Autopilot::kPx4Multicopter), IsEmpty());
  const auto set_leg = [&](int leg, double p) {
    for (std::size_t i = 0; i < input.mission.flight.samples.size(); ++i) {
      ErrorSample& sample = input.selection.error_profile[i];
      if (input.mission.flight.samples[i].leg == leg && sample.matchable) sample.p_correct_fix = p;
    }
  };
  // The tries after 2 and 4 s fail: p (1 − p)² of those on the leg, each behind a fix.
  for (FlightSample& sample : input.mission.flight.samples) sample.speed_mps = 20;
  double leg_s = 0;
  const std::vector<FlightSample>& samples = input.mission.flight.samples;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    const std::vector<ErrorSample>& profile = input.selection.error_profile;
    if (samples[i].leg == 0 && profile[i].matchable && profile[i + 1].matchable) {
      leg_s += (samples[i + 1].distance_m - samples[i].distance_m) / 20;
    }
  }
  const double p = 0.6;
  const double expected = leg_s / 2 * p * (1 - p) * (1 - p);
  ASSERT_GT(expected, 0.3);
  for (ErrorSample& sample : input.selection.error_profile) sample.p_correct_fix = sample.matchable ? 1 : 0;
  set_leg(0, p);
  std::ostringstream times;
  times << std::fixed << std::setprecision(1) << expected;
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4Multicopter),
              ElementsAre(HasSubstr("2 tries in a row without a fix are as long, expected " + times.str() +
                                    " times on the flight, most on leg 1 (modelled")));
  set_leg(0, 1);
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4Multicopter), ElementsAre(Not(HasSubstr("tries in a row"))))
      << "the gap alone";
  set_leg(0, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4Multicopter), ElementsAre(Not(HasSubstr("tries in a row"))));
  input.selection.tries->interval_s = 8;
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4Multicopter), ElementsAre(HasSubstr("fixes come every 8 s at most")));
  input.mission.flight.denied.stretches = {{0, 60}};  // for three seconds
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4Multicopter), IsEmpty());
}

TEST(AutopilotSheet, GroundThatMayPassBetweenTwoTriesEndsNoSilence) {
  ReportInput input = input_with_gap(40);
  const auto set_island = [&](double seconds) {
    const auto [from_m, to_m] = gap_of(input);
    const double middle_m = (from_m + to_m) / 2, speed_mps = (to_m - from_m) / 40;
    for (std::size_t i = 0; i < input.mission.flight.samples.size(); ++i) {
      const double along_m = input.mission.flight.samples[i].distance_m;
      if (along_m > from_m && along_m < to_m) {
        input.selection.error_profile[i].matchable = std::abs(along_m - middle_m) < seconds / 2 * speed_mps;
      }
    }
  };
  set_island(1.5);
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4FixedWing), ElementsAre(HasSubstr("one stretch is longer, 42 s")));
  set_island(6);
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4FixedWing),
              ElementsAre(HasSubstr("2 stretches are longer, the longest 19 s")));
}

TEST(AutopilotSheet, BeyondTheMessagesLargestSigmaNothingIsSent) {
  ReportInput input = input_with_gap(1);
  const auto set_gap_error = [&](double error_m) {
    for (ErrorSample& sample : input.selection.error_profile) sample.error_m = sample.matchable ? 10 : error_m;
  };
  input.selection.sigma_multiple = 3;
  set_gap_error(299);
  EXPECT_THAT(warnings_of(input, Autopilot::kArduplane), IsEmpty());
  set_gap_error(303);
  EXPECT_THAT(warnings_of(input, Autopilot::kArduplane),
              ElementsAre(HasSubstr("it reaches 101 m (1.1 km – 3.2 km, legs 2 to 4)")));
  EXPECT_THAT(warnings_of(input, Autopilot::kPx4FixedWing), IsEmpty());
}

TEST(AutopilotSheet, ParametersOfPx4AreLinesOfQgroundcontrol) {
  ReportInput input = input_with_gap(1);
  input.selection.max_error_m = 60;
  input.selection.sigma_multiple = 3;
  EXPECT_THAT(
      set_lines(parameters_of(input, Autopilot::kPx4Multicopter)),
      ElementsAre("1\t1\tEKF2_AGP0_ID\t1\t6", "1\t1\tEKF2_AGP0_CTRL\t1\t6", "1\t1\tEKF2_HGT_REF\t0\t6",
                  "1\t1\tEKF2_AGP0_MODE\t0\t6", "1\t1\tEKF2_AGP0_NOISE\t2.00\t9", "1\t1\tCOM_POS_FS_EPH\t8.0\t9"));
  input = input_with_gap(9);
  input.mission.flight.denied.stretches = {{0, gap_of(input).second + 100}};
  const std::string text = parameters_of(input, Autopilot::kPx4FixedWing);
  EXPECT_THAT(set_lines(text), Contains("1\t1\tEKF2_NOAID_TOUT\t10000000\t6"));
  EXPECT_THAT(set_lines(text), Contains("1\t1\tEKF2_AGP0_MODE\t1\t6"));
  EXPECT_THAT(text, HasSubstr("WARNING: not enough, one stretch is longer, 11 s")) << "than ten seconds, too";
  EXPECT_THAT(parameters_of(input_with_gap(7), Autopilot::kPx4FixedWing), Not(HasSubstr("not enough")));
}

TEST(AutopilotSheet, ParametersOfArdupilotFuseNoVelocity) {
  ReportInput input = input_with_gap(60);
  input.mission.flight.conditions.map_sigma_m = 30;
  for (const Autopilot autopilot : {Autopilot::kArducopter, Autopilot::kArduplane}) {
    const std::string text = parameters_of(input, autopilot);
    EXPECT_THAT(set_lines(text), ElementsAre("GPS2_TYPE,14", "GPS2_DELAY_MS,1", "EK3_SRC2_POSXY,3", "EK3_SRC2_VELXY,0",
                                             "EK3_SRC2_POSZ,1", "EK3_SRC2_VELZ,0", "EK3_SRC2_YAW,1",
                                             "EK3_SRC_OPTIONS,0", "EK3_GPS_CHECK,0", "EK3_POSNE_M_NSE,10.00"))
        << "at most what the parameter takes";
    EXPECT_THAT(text, HasSubstr("# WARNING: ArduPilot gives up a position"));
  }
}

TEST(AutopilotSheet, ATitleBeginsNoParameter) {
  ReportInput input = input_with_gap(1);
  input.title = "route\nFS_EKF_ACTION,0";
  const std::string text = parameters_of(input, Autopilot::kArduplane);
  EXPECT_THAT(set_lines(text), Not(Contains(HasSubstr("FS_EKF"))));
  EXPECT_THAT(text, HasSubstr("route FS_EKF_ACTION,0"));
}

TEST(AutopilotSheet, AReportOfAnAutopilotWarns) {
  ReportInput input = input_with_gap(40);
  const std::size_t before = make_report(input).warnings.size();
  input.mission.flight.autopilot = Autopilot::kPx4Multicopter;
  const Report report = make_report(input);
  ASSERT_EQ(report.warnings.size(), before + 1);
  EXPECT_THAT(report.warnings.back(), HasSubstr("EKF2_NOAID_TOUT"));
}

}  // namespace
}  // namespace pilotage
