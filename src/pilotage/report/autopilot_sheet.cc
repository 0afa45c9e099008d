#include "pilotage/report/autopilot_sheet.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "pilotage/base/wording.h"
#include "pilotage/mission/flight_conditions.h"
#include "pilotage/mission/flight_time.h"
#include "pilotage/mission/gnss_availability.h"
#include "pilotage/report/report.h"
#include "pilotage/report/stretch_reasons.h"

namespace pilotage {
namespace {

constexpr double kPx4NoAid_s = 5;  // EKF2_NOAID_TOUT by default
constexpr double kPx4MostNoAid_s = 10;
constexpr double kEkf3Retry_s = 7;        // posRetryTimeNoVel_ms
constexpr double kEkf3MostSigma_m = 100;  // of a position: larger ones count as this
constexpr double kRareMisses = 0.01;      // on a flight

/// A stretch without GNSS and without a try that may succeed.
struct Silence {
  int leg = 0;
  double from_distance_m = 0;
  double to_distance_m = 0;
  double duration_s = 0;  ///< With the wait for the first try behind it.
  double sigma_m = 0;     ///< Largest on it.
};

double interval_s(const ReportInput& input) {
  return input.selection.tries ? input.selection.tries->interval_s : 0;
}

/// From a sample of the flight to the next.
struct Step {
  const FlightSample* sample = nullptr;
  double end_distance_m = 0;
  double duration_s = 0;
  double denied_s = 0;  ///< How long GNSS is away, all in all, where it is away here; else 0.
  bool matchable = false;
  double p_correct_fix = 0;
  double sigma_m = 0;  ///< At its end.
};

/// Empty where the selection is of other samples than the flight's.
std::vector<Step> steps_of(const ReportInput& input) {
  const std::vector<FlightSample>& samples = input.mission.flight.samples;
  const std::vector<ErrorSample>& profile = input.selection.error_profile;
  const GnssAvailability gnss = gnss_availability(input.mission.flight);
  std::vector<Step> steps;
  if (profile.size() != samples.size()) return steps;
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    Step step;
    step.sample = &samples[i];
    step.end_distance_m = samples[i + 1].distance_m;
    step.duration_s = step_time_s(samples[i], samples[i + 1]);
    step.matchable = profile[i].matchable && profile[i + 1].matchable;
    step.p_correct_fix = profile[i].p_correct_fix;
    step.sigma_m = profile[i + 1].error_m / input.selection.sigma_multiple;
    steps.push_back(step);
  }
  for (std::size_t begin = 0; begin < steps.size(); ++begin) {
    std::size_t end = begin;
    double denied_s = 0;
    for (; end < steps.size() && !gnss.over_step[end]; ++end) denied_s += steps[end].duration_s;
    for (; begin < end; ++begin) steps[begin].denied_s = denied_s;
  }
  return steps;
}

/// Longest first. Matchable ground that is flown over in less than the time between two tries may see none: it ends no
/// silence.
std::vector<Silence> silences(const ReportInput& input) {
  std::vector<Silence> found;
  bool open = false;
  double matchable_s = 0;  // flown since the last step that was silent
  for (const Step& step : steps_of(input)) {
    const bool is_denied = step.denied_s > 0;
    if (is_denied && !step.matchable) {
      if (!open) found.push_back({step.sample->leg, step.sample->distance_m, 0, 0, 0});
      Silence& silence = found.back();
      silence.duration_s += step.duration_s + (open ? matchable_s : 0);
      silence.to_distance_m = step.end_distance_m;
      silence.sigma_m = std::max(silence.sigma_m, step.sigma_m);
      open = true;
      matchable_s = 0;
    } else if (open) {
      if (is_denied) matchable_s += step.duration_s;
      open = is_denied && matchable_s < interval_s(input);
      if (!open) found.back().duration_s += std::min(matchable_s, interval_s(input));
    }
  }
  if (open) found.back().duration_s += matchable_s;
  std::stable_sort(found.begin(), found.end(),
                   [](const Silence& a, const Silence& b) { return a.duration_s > b.duration_s; });
  return found;
}

std::string place_text(const Report& report, const Silence& silence) {
  return where_text(report, silence.from_distance_m, silence.to_distance_m, silence.leg);
}

/// "3 stretches are longer, the longest 37 s (1.5 km – 2.2 km, leg 5)"; "" where none is.
std::string longer_than(const ReportInput& input, const Report& report, double limit_s) {
  const std::vector<Silence> found = silences(input);
  const auto count =
      std::count_if(found.begin(), found.end(), [&](const Silence& silence) { return silence.duration_s > limit_s; });
  if (count == 0) return "";
  const std::string length =
      number_text(found.front().duration_s, 0) + " s (" + place_text(report, found.front()) + ")";
  return count == 1 ? "one stretch is longer, " + length
                    : std::to_string(count) + " stretches are longer, the longest " + length;
}

/// How often on this flight, over matchable ground, so many tries in a row fail that the time passes, where GNSS is
/// away for as long; "" where that is hardly ever.
std::string likely_misses(const ReportInput& input, double limit_s) {
  const double between_s = interval_s(input);
  if (!(between_s > 0)) return "";
  const int misses = static_cast<int>(std::floor(limit_s / between_s));
  std::map<int, double> by_leg;
  double expected = 0;
  for (const Step& step : steps_of(input)) {
    if (step.denied_s <= limit_s || !step.matchable) continue;
    if (misses == 0) return "fixes come every " + number_text(between_s, 0) + " s at most";
    if (!std::isfinite(step.p_correct_fix)) continue;
    // Each begins behind a fix.
    const double begun = step.duration_s / between_s * step.p_correct_fix * std::pow(1 - step.p_correct_fix, misses);
    by_leg[step.sample->leg] += begun;
    expected += begun;
  }
  if (expected < kRareMisses) return "";
  const auto most =
      std::max_element(by_leg.begin(), by_leg.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return (misses == 1 ? "one try without a fix is as long"
                      : std::to_string(misses) + " tries in a row without a fix are as long") +
         ", expected " + number_text(expected, expected < 0.1 ? 2 : 1) + " times on the flight, most on leg " +
         std::to_string(most->first + 1) + " (modelled, as if tries did not depend on each other)";
}

/// What the autopilot does without positions, and after how long.
struct Patience {
  double limit_s = 0;
  std::string text;
};

Patience patience_of(Autopilot autopilot) {
  switch (autopilot) {
    case Autopilot::kPx4Multicopter:
      return {kPx4NoAid_s,
              "PX4 gives up a multicopter's position 5 s after the last fix (EKF2_NOAID_TOUT, at most 10 s), and "
              "flies its failsafe"};
    case Autopilot::kPx4FixedWing:
      return {kPx4NoAid_s,
              "PX4 gives up a position 5 s after the last fix (EKF2_NOAID_TOUT, at most 10 s) unless it measures "
              "airspeed and reckons with it (EKF2_ARSP_THR, EKF2_FUSE_BETA); then it circles for FW_GPSF_LT, 30 s, "
              "and descends"};
    case Autopilot::kArducopter:
      return {kEkf3Retry_s,
              "ArduPilot gives up a position 7 s after the last one (10 s with a model of drag or optical flow) and "
              "flies its EKF failsafe. There it lives on the positions of the onboard filter (GPS_INPUT) alone; fixes "
              "by themselves, or a program that stops, do not do"};
    case Autopilot::kArduplane:
      return {kEkf3Retry_s,
              "ArduPilot gives up a position 7 s after the last one (10 s with airspeed) and reckons on by the wind. "
              "There it lives on the positions of the onboard filter (GPS_INPUT) alone; fixes by themselves, or a "
              "program that stops, do not do"};
  }
  return {};
}

/// For a comment: a line break would begin a parameter.
std::string one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](unsigned char letter) { return letter < ' '; }, ' ');
  return text;
}

struct Parameter {
  std::string name;
  std::string value;
  std::string why;
  bool is_real = false;
};

/// Of a fix, as the plan takes it: each axis.
double fix_sigma_m(const ReportInput& input) {
  return make_error_model(input.mission.flight.ins, input.mission.flight.conditions).fixed_position_sigma_m();
}

/// Whether GNSS is had anywhere.
bool has_gnss(const ReportInput& input) {
  const std::vector<bool> had = gnss_availability(input.mission.flight).over_step;
  return input.mission.flight.denied.anywhere || std::find(had.begin(), had.end(), true) != had.end();
}

std::vector<Parameter> px4_parameters(const ReportInput& input, const Report& report, Autopilot autopilot) {
  const Parameter mode =
      has_gnss(input)
          ? Parameter{"EKF2_AGP0_MODE", "1", "GNSS is had on part of the way: fixes reset only what reckons."}
          : Parameter{"EKF2_AGP0_MODE", "0", "No GNSS from the first point on: fixes may begin and reset."};
  std::vector<Parameter> parameters = {
      {"EKF2_AGP0_ID", "1", "The source's number: --sensor-id of the onboard program."},
      {"EKF2_AGP0_CTRL", "1", "Its horizontal position is fused, no height."},
      {"EKF2_HGT_REF", "0", "Heights are the barometer's, where GNSS may fail."},
      mode,
      {"EKF2_AGP0_NOISE", number_text(fix_sigma_m(input), 2),
       "m: no fix counts for better than the plan takes it for (its own error and the map's).", true}};
  if (!longer_than(input, report, kPx4NoAid_s).empty() || !likely_misses(input, kPx4NoAid_s).empty()) {
    const std::string beyond = longer_than(input, report, kPx4MostNoAid_s);
    parameters.push_back({"EKF2_NOAID_TOUT", "10000000",
                          "us: the longest that it takes, 5 s by default." +
                              (beyond.empty() ? "" : " WARNING: not enough, " + beyond + ".")});
  }
  if (autopilot == Autopilot::kPx4Multicopter) {
    constexpr double kHysteresis = 2.5, kMost_m = 400;
    const double sigma_m =
        std::min(kMost_m * kHysteresis, input.selection.max_error_m / input.selection.sigma_multiple);
    parameters.push_back({"COM_POS_FS_EPH", number_text(std::max(0.1, sigma_m / kHysteresis), 1),
                          "m: once the position was good PX4 waits for 2.5 times this, here a sigma of " +
                              number_text(sigma_m, 1) + " m, which is the plan's limit.",
                          true});
  }
  return parameters;
}

std::vector<Parameter> ardupilot_parameters(const ReportInput& input) {
  return {
      {"GPS2_TYPE", "14", "The second receiver is MAVLink: the onboard program, --sensor-id 1. GPS_TYPE2 before 4.6."},
      {"GPS2_DELAY_MS", "1", "Its positions are of now; 0 would mean 100 ms. GPS_DELAY_MS2 before 4.6."},
      {"EK3_SRC2_POSXY", "3", "The second set of sources: position of the receiver ..."},
      {"EK3_SRC2_VELXY", "0", "... without velocity, which the message does not hold: it would count as zero."},
      {"EK3_SRC2_POSZ", "1", "Barometer."},
      {"EK3_SRC2_VELZ", "0", "None."},
      {"EK3_SRC2_YAW", "1", "Compass."},
      {"EK3_SRC_OPTIONS", "0", "Bit 0 would fuse the velocity of a set that is not chosen."},
      {"EK3_GPS_CHECK", "0",
       "Its checks ask for satellites, dilution of precision and 5 m. They fall away for the other receiver, too."},
      {"EK3_POSNE_M_NSE", number_text(std::clamp(fix_sigma_m(input), 0.1, 10.0), 2),
       "m: no position counts for better than the plan takes a fix for (its own error and the map's), that of the "
       "other receiver neither.",
       true}};
}

/// What the planner has to decide, or to measure first.
std::vector<std::string> remarks(Autopilot autopilot) {
  if (is_px4(autopilot)) {
    return {
        "Not set here: EKF2_AGP0_DELAY, ms from exposure to answer, which the onboard program prints when it ends; "
        "EKF2_DELAY_MAX must not be less.",
        "Not set here: EKF2_GPS_CTRL. A receiver that is deceived is fused as long as EKF2 believes it.",
        "After 5 s without a fix PX4 counts the source as stopped, whatever EKF2_NOAID_TOUT says; the next fix "
        "starts it again.",
        "Versions that know EKF2_AGP_CTRL instead of EKF2_AGP0_CTRL do not take these positions over MAVLink."};
  }
  std::vector<std::string> remarks = {
      "Not set here: which receiver is taken. A set of sources says GPS, not which: with GPS_AUTO_SWITCH 1 it is the "
      "one with the better status, so a deceived one that has a fix stays in use.",
      "Choose the second set (RC option 90, MAV_CMD_SET_EKF_SOURCE_SET) before GNSS is lost: where the first receiver "
      "fails under a set with velocity, the second's missing one counts as zero."};
  if (autopilot == Autopilot::kArduplane) {
    remarks.emplace_back("AHRS_OPTIONS: set bit 0, or it falls back to DCM when EKF3 doubts.");
  } else {
    remarks.emplace_back(
        "FS_DR_ENABLE acts as soon as EKF3 reckons without positions, FS_DR_TIMEOUT (30 s) later the EKF failsafe.");
  }
  return remarks;
}

std::string autopilot_name(Autopilot autopilot) {
  switch (autopilot) {
    case Autopilot::kPx4Multicopter:
      return "PX4, multicopter";
    case Autopilot::kPx4FixedWing:
      return "PX4, fixed wing";
    case Autopilot::kArducopter:
      return "ArduPilot Copter";
    case Autopilot::kArduplane:
      return "ArduPilot Plane";
  }
  return "";
}

}  // namespace

bool is_px4(Autopilot autopilot) {
  return autopilot == Autopilot::kPx4Multicopter || autopilot == Autopilot::kPx4FixedWing;
}

std::vector<std::string> autopilot_warnings(const ReportInput& input, const Report& report, Autopilot autopilot) {
  std::vector<std::string> warnings;
  const Patience patience = patience_of(autopilot);
  const std::string longer = longer_than(input, report, patience.limit_s);
  const std::string misses = likely_misses(input, patience.limit_s);
  if (!longer.empty() || !misses.empty()) {
    warnings.push_back(patience.text + ": " + longer + (longer.empty() || misses.empty() ? "" : "; ") + misses);
  }
  if (is_px4(autopilot)) return warnings;
  const std::vector<Silence> found = silences(input);
  const auto worst = std::max_element(found.begin(), found.end(),
                                      [](const Silence& a, const Silence& b) { return a.sigma_m < b.sigma_m; });
  if (worst != found.end() && worst->sigma_m > kEkf3MostSigma_m) {
    warnings.push_back(
        "beyond a sigma of 100 m the onboard program has no fix in GPS_INPUT, and after 5 s so none any more: it "
        "reaches " +
        number_text(worst->sigma_m, 0) + " m (" + place_text(report, *worst) + ")");
  }
  return warnings;
}

std::string autopilot_parameters(const ReportInput& input, const Report& report, Autopilot autopilot) {
  const bool px4 = is_px4(autopilot);
  std::string text = "# Parameters for " + autopilot_name(autopilot) + " with positions by sight (" +
                     (px4 ? "GLOBAL_POSITION_SENSOR" : "GPS_INPUT") + "): " + one_line(report.title) + "\n# " +
                     report.software_version +
                     ". Names and meanings are those of the autopilot's sources of early 2026; none of it was tried on "
                     "an autopilot.\n";
  const auto comment = [&text](const std::string& line) { text += "# " + line + "\n"; };
  for (const std::string& remark : remarks(autopilot)) comment(remark);
  for (const std::string& warning : autopilot_warnings(input, report, autopilot)) comment("WARNING: " + warning + ".");
  if (px4) comment("Vehicle-Id Component-Id Name Value Type");
  for (const Parameter& parameter : px4 ? px4_parameters(input, report, autopilot) : ardupilot_parameters(input)) {
    comment(parameter.why);
    text += px4 ? "1\t1\t" + parameter.name + "\t" + parameter.value + "\t" + (parameter.is_real ? "9" : "6") + "\n"
                : parameter.name + "," + parameter.value + "\n";
  }
  return text;
}

}  // namespace pilotage
