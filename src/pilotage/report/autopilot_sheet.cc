#include "pilotage/report/autopilot_sheet.h"

#include <algorithm>
#include <cmath>

#include "pilotage/report/report.h"
#include "pilotage/report/stretch_reasons.h"
#include "pilotage/report/wording.h"

namespace pilotage {
namespace {

constexpr double kPx4NoAid_s = 5;  // EKF2_NOAID_TOUT by default
constexpr double kPx4MostNoAid_s = 10;
constexpr double kEkf3Retry_s = 7;               // posRetryTimeNoVel_ms
constexpr double kEkf3RetryWithVelocity_s = 10;  // posRetryTimeUseVel_ms
constexpr double kEkf3MostSigma_m = 100;         // of a position, which it takes larger ones for
constexpr double kRareMisses = 0.01;

/// A stretch over which no fix is expected and GNSS is denied.
struct Silence {
  const ReportGap* gap = nullptr;
  double duration_s = 0;
  double sigma_m = 0;  ///< At its end.
};

/// The share of the stretch in which GNSS is denied.
double denied_share(const Report& report, double from_m, double to_m) {
  if (report.denied.empty() || report.loss_anywhere) return 1;
  double denied_m = 0;
  for (const DeniedStretch& stretch : report.denied) {
    denied_m += std::max(0.0, std::min(to_m, stretch.to_distance_m) - std::max(from_m, stretch.from_distance_m));
  }
  return to_m > from_m ? denied_m / (to_m - from_m) : 0;
}

/// Longest first.
std::vector<Silence> silences(const Report& report) {
  std::vector<Silence> found;
  for (const ReportGap& gap : report.gaps) {
    const double share = denied_share(report, gap.gap.from_distance_m, gap.gap.to_distance_m);
    if (share > 0) {
      found.push_back({&gap, gap.gap.duration_s * share + report.fix_interval_s,
                       gap.gap.error_m / std::max(1.0, report.sigma_multiple)});
    }
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Silence& a, const Silence& b) { return a.duration_s > b.duration_s; });
  return found;
}

/// "3 gaps are longer, the longest 37 s (1.5 km – 2.2 km, leg 5)"; "" where none is.
std::string longer_than(const Report& report, double limit_s) {
  const std::vector<Silence> found = silences(report);
  const auto count =
      std::count_if(found.begin(), found.end(), [&](const Silence& s) { return s.duration_s > limit_s; });
  if (count == 0) return "";
  const RouteGap& longest = found.front().gap->gap;
  const std::string where = where_text(report, longest.from_distance_m, longest.to_distance_m, longest.leg);
  const std::string length = number_text(found.front().duration_s, 0) + " s (" + where + ")";
  return count == 1 ? "one gap is longer, " + length
                    : std::to_string(count) + " gaps are longer, the longest " + length;
}

/// Legs on which so many tries in a row fail more often than rarely that the time passes; "" without any.
std::string likely_misses(const Report& report, double limit_s) {
  if (!(report.fix_interval_s > 0)) return "";
  const double tries = std::ceil(limit_s / report.fix_interval_s);
  std::vector<std::string> legs;
  for (std::size_t i = 0; i < report.legs.size(); ++i) {
    const ReportLeg& leg = report.legs[i];
    const double to_m = leg.from_distance_m + leg.status.length_m;
    if (denied_share(report, leg.from_distance_m, to_m) <= 0 || !std::isfinite(leg.status.p_fix)) continue;
    if (std::pow(1 - leg.status.p_fix, tries) > kRareMisses) legs.push_back(std::to_string(i + 1));
  }
  if (legs.empty()) return "";
  return "so long a silence also comes of " + number_text(tries, 0) + " tries in a row without a fix: more than " +
         number_text(kRareMisses * 100, 0) + " % of the times on " + (legs.size() == 1 ? "leg " : "legs ") +
         listed(legs) + " (modelled, as if tries did not depend on each other)";
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
              "ArduPilot gives up a position 7 s after the last one (10 s with a model of drag or optical flow) "
              "and flies its EKF failsafe: between fixes it needs the onboard filter's positions (GPS_INPUT), fixes "
              "alone do not do"};
    case Autopilot::kArduplane:
      return {kEkf3RetryWithVelocity_s,
              "ArduPilot gives up a position 10 s after the last one (7 s without airspeed) and reckons on by the "
              "wind: between fixes it needs the onboard filter's positions (GPS_INPUT), fixes alone do not do"};
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

std::vector<Parameter> px4_parameters(const Report& report, Autopilot autopilot) {
  std::vector<Parameter> parameters = {
      {"EKF2_AGP0_ID", "1", "The source's number: --sensor-id of the onboard program."},
      {"EKF2_AGP0_CTRL", "1", "Its horizontal position is fused; heights are the barometer's."},
      report.denied.empty()
          ? Parameter{"EKF2_AGP0_MODE", "0", "No GNSS from the first point on: positions by sight may begin and reset."}
          : Parameter{"EKF2_AGP0_MODE", "1",
                      "GNSS is there on part of the way: positions by sight reset only what reckons."},
      {"EKF2_AGP0_NOISE", number_text(report.fix_sigma_m, 2),
       "m: no fix counts for better than the plan takes it for, whatever it says of itself.", true}};
  if (!longer_than(report, kPx4NoAid_s).empty()) {
    parameters.push_back({"EKF2_NOAID_TOUT", "10000000", "us: the longest that it takes. By default 5 s."});
  }
  if (autopilot == Autopilot::kPx4Multicopter) {
    parameters.push_back({"COM_POS_FS_EPH", number_text(report.max_error_m / report.sigma_multiple, 1),
                          "m: sigma at which the plan's limit is reached, in place of 5 m.", true});
  }
  return parameters;
}

std::vector<Parameter> ardupilot_parameters(const Report& report) {
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
      {"EK3_POSNE_M_NSE", number_text(std::clamp(report.fix_sigma_m, 0.1, 10.0), 2),
       "m: no position counts for better than the plan takes a fix for.", true}};
}

/// What the planner has to decide, or to measure first.
std::vector<std::string> remarks(Autopilot autopilot) {
  if (is_px4(autopilot)) {
    return {
        "Not set here: EKF2_AGP0_DELAY, ms from exposure to answer, which the onboard program prints when it ends; "
        "EKF2_DELAY_MAX must not be less.",
        "Versions that know EKF2_AGP_CTRL instead of EKF2_AGP0_CTRL do not take these positions over MAVLink."};
  }
  std::vector<std::string> remarks = {
      "Not set here: which receiver is taken. A set of sources says GPS, not which: with GPS_AUTO_SWITCH 1 the one "
      "with the "
      "better status, so a deceived one that has a fix stays in use.",
      "Choose the second set (RC option 90, MAV_CMD_SET_EKF_SOURCE_SET) before GNSS is lost: where the first receiver "
      "fails under a set with velocity, the second's missing one counts as zero."};
  if (autopilot == Autopilot::kArduplane) {
    remarks.push_back("AHRS_OPTIONS: set bit 0, or it falls back to DCM when EKF3 doubts.");
  } else {
    remarks.push_back(
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

std::vector<std::string> autopilot_warnings(const Report& report, Autopilot autopilot) {
  std::vector<std::string> warnings;
  const Patience patience = patience_of(autopilot);
  const std::string gaps = longer_than(report, patience.limit_s);
  const std::string misses = likely_misses(report, patience.limit_s);
  if (!gaps.empty() || !misses.empty()) {
    warnings.push_back(patience.text + ": " + gaps + (gaps.empty() || misses.empty() ? "" : "; ") + misses);
  }
  for (const Silence& silence : silences(report)) {
    if (is_px4(autopilot) || !(silence.sigma_m > kEkf3MostSigma_m)) continue;
    const RouteGap& gap = silence.gap->gap;
    warnings.push_back(
        "beyond a sigma of 100 m the onboard program has no fix in GPS_INPUT, and after 5 s so none any "
        "more: " +
        number_text(silence.sigma_m, 0) + " m at the end of " +
        where_text(report, gap.from_distance_m, gap.to_distance_m, gap.leg));
  }
  return warnings;
}

std::string autopilot_parameters(const Report& report, Autopilot autopilot) {
  const bool px4 = is_px4(autopilot);
  std::string text = "# Parameters for " + autopilot_name(autopilot) + " with positions by sight (" +
                     (px4 ? "GLOBAL_POSITION_SENSOR" : "GPS_INPUT") + "): " + one_line(report.title) + "\n# " +
                     report.software_version +
                     ". Names and meanings are those of the autopilot's sources of early 2026; none of it was tried on "
                     "an autopilot.\n";
  const auto comment = [&text](const std::string& line) { text += "# " + line + "\n"; };
  for (const std::string& remark : remarks(autopilot)) comment(remark);
  for (const std::string& warning : autopilot_warnings(report, autopilot)) comment("WARNING: " + warning + ".");
  if (px4) comment("Vehicle-Id Component-Id Name Value Type");
  for (const Parameter& parameter : px4 ? px4_parameters(report, autopilot) : ardupilot_parameters(report)) {
    comment(parameter.why);
    text += px4 ? "1\t1\t" + parameter.name + "\t" + parameter.value + "\t" + (parameter.is_real ? "9" : "6") + "\n"
                : parameter.name + "," + parameter.value + "\n";
  }
  return text;
}

}  // namespace pilotage
