#include "pilotage/vehiclelog/log_builder.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pilotage/base/angle.h"
#include "pilotage/base/nan.h"
#include "pilotage/vehiclelog/pose_at.h"

namespace pilotage {
namespace {

constexpr double kHighest_m = 1e5;
constexpr double kFastest_mps = 1e4;
constexpr double kLatestTime_s = 1e11;  // in µs still below 2^53
/// Farther from its range's attitude none is known.
constexpr double kAttitudeReach_s = 1;
/// A beam that is tilted by more than 45° tells of other ground.
constexpr double kLeastUpright = 0.7071;

bool is_height(double height_m) {
  return std::isfinite(height_m) && std::abs(height_m) <= kHighest_m;
}

bool is_attitude(const Attitude& attitude) {
  return std::isfinite(attitude.yaw_deg) && std::isfinite(attitude.pitch_deg) && std::isfinite(attitude.roll_deg) &&
         std::abs(attitude.yaw_deg) <= 720 && std::abs(attitude.pitch_deg) <= 180 && std::abs(attitude.roll_deg) <= 360;
}

template <class Record>
void sort_by_time(std::vector<Record>& records) {
  std::stable_sort(records.begin(), records.end(),
                   [](const Record& a, const Record& b) { return a.time_s < b.time_s; });
}

void sort_by_time(LoggedTrack& track) {
  sort_by_time(track.positions);
  sort_by_time(track.velocities);
  sort_by_time(track.attitudes);
}

}  // namespace

std::optional<Attitude> attitude_of_quaternion(double w, double x, double y, double z) {
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  if (!(length > 0.9 && length < 1.1)) return std::nullopt;
  const Eigen::Matrix3d ned_from_body = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
  const double pitch_rad = std::asin(std::clamp(-ned_from_body(2, 0), -1.0, 1.0));
  return Attitude{std::atan2(ned_from_body(1, 0), ned_from_body(0, 0)) / kRadPerDeg, pitch_rad / kRadPerDeg,
                  std::atan2(ned_from_body(2, 1), ned_from_body(2, 2)) / kRadPerDeg};
}

bool is_logged_point(double lat_deg, double lon_deg) {
  return std::abs(lat_deg) <= 90 && std::abs(lon_deg) <= 180 && !(lat_deg == 0 && lon_deg == 0);
}

LogBuilder::LogBuilder(LogFormat format) : format_(format) {
  part_.log.format = format;
}

bool LogBuilder::agrees(double time_s, double last_s) const {
  return time_s >= last_s - kLogClockSlack_s && time_s <= last_s + kLongestLogGap_s;
}

bool LogBuilder::accept(double time_s) {
  if (!(std::abs(time_s) <= kLatestTime_s)) {
    ++losses_.bad_times;
    return false;
  }
  if (!last_s_ || agrees(time_s, *last_s_)) {
    last_s_ = last_s_ ? std::max(*last_s_, time_s) : time_s;
    doubtful_ = 0;
    ++part_.records;
    return true;
  }
  doubtful_ = doubtful_ > 0 && agrees(time_s, doubtful_s_) ? doubtful_ + 1 : 1;
  doubtful_s_ = time_s;
  if (doubtful_ < kRecordsThatSetClock) {
    ++losses_.bad_times;
    return false;
  }
  if (time_s < *last_s_) {
    begin_part();
  } else {
    ++losses_.gaps;
  }
  doubtful_ = 0;
  last_s_ = time_s;
  ++part_.records;
  return true;
}

void LogBuilder::begin_part() {
  ++losses_.clock_jumps;
  const bool larger = part_.records > largest_.records;
  losses_.records_left_out += std::min(part_.records, largest_.records);
  if (larger) largest_ = std::move(part_);
  part_ = {};
  part_.log.format = format_;
}

void LogBuilder::add_position(LoggedTrack VehicleLog::*track, double time_s, double lat_deg, double lon_deg,
                              double amsl_m) {
  if (!is_logged_point(lat_deg, lon_deg)) {
    ++losses_.bad_values;
    return;
  }
  (part_.log.*track).positions.push_back({time_s, {lon_deg, lat_deg}, is_height(amsl_m) ? amsl_m : kNaN});
}

void LogBuilder::add_velocity(LoggedTrack VehicleLog::*track, double time_s, double north_mps, double east_mps,
                              double down_mps) {
  const double fastest = std::max({std::abs(north_mps), std::abs(east_mps), std::abs(down_mps)});
  if (!(fastest <= kFastest_mps) || std::isnan(north_mps + east_mps + down_mps)) {
    ++losses_.bad_values;
    return;
  }
  (part_.log.*track).velocities.push_back({time_s, north_mps, east_mps, down_mps});
}

void LogBuilder::add_attitude(LoggedTrack VehicleLog::*track, double time_s, const Attitude& attitude) {
  if (!is_attitude(attitude)) {
    ++losses_.bad_values;
    return;
  }
  (part_.log.*track).attitudes.push_back({time_s, attitude});
}

void LogBuilder::add_height(double time_s, double agl_m) {
  if (!is_height(agl_m) || agl_m < 0) {
    ++losses_.bad_values;
    return;
  }
  part_.log.heights.push_back({time_s, agl_m});
}

void LogBuilder::add_range(double time_s, const std::string& sensor, double range_m) {
  if (!is_height(range_m) || range_m <= 0) {
    ++losses_.bad_values;
    return;
  }
  part_.ranges[sensor].push_back({time_s, range_m});
}

void LogBuilder::take_ranges(Part& part) {
  const auto most = std::max_element(part.ranges.begin(), part.ranges.end(),
                                     [](const auto& a, const auto& b) { return a.second.size() < b.second.size(); });
  if (most == part.ranges.end()) return;
  for (const auto& [sensor, ranges] : part.ranges) {
    if (sensor != most->first) losses_.other_sources[sensor] += std::ssize(ranges);
  }
  const LoggedTrack& track = part.log.estimate.attitudes.empty() ? part.log.truth : part.log.estimate;
  for (const LoggedHeight& range : most->second) {
    const auto attitude = attitude_at(track.attitudes, range.time_s, kAttitudeReach_s);
    const double upright =
        attitude ? std::cos(attitude->pitch_deg * kRadPerDeg) * std::cos(attitude->roll_deg * kRadPerDeg) : 1;
    if (upright < kLeastUpright) {
      ++losses_.ranges_left_out;
      continue;
    }
    part.log.ranges.push_back({range.time_s, range.agl_m * upright});
  }
  sort_by_time(part.log.ranges);
}

void LogBuilder::leave_out_source(const std::string& source) {
  constexpr std::size_t kMostSources = 8;  // each is a note
  const bool known = losses_.other_sources.contains(source);
  ++losses_.other_sources[known || losses_.other_sources.size() < kMostSources ? source : "other sources"];
}

std::int64_t capture_number(double stated) {
  constexpr double kMost = 0x1p53;  // beyond it doubles do not count
  return stated >= 0 && stated <= kMost && stated == std::floor(stated) ? static_cast<std::int64_t>(stated) : 0;
}

void LogBuilder::add_capture(LoggedCapture capture) {
  if (capture.point && !is_logged_point(capture.point->lat_deg, capture.point->lon_deg)) capture.point.reset();
  if (capture.attitude && !is_attitude(*capture.attitude)) capture.attitude.reset();
  if (!is_height(capture.amsl_m)) capture.amsl_m = kNaN;
  if (!is_height(capture.agl_m) || capture.agl_m <= 0) capture.agl_m = kNaN;
  part_.log.captures.push_back(std::move(capture));
}

void LogBuilder::set_utc(double utc_minus_log_s) {
  if (!part_.log.utc_minus_log_s && std::abs(utc_minus_log_s) <= kLatestTime_s) {
    part_.log.utc_minus_log_s = utc_minus_log_s;
  }
}

VehicleLog LogBuilder::finish() {
  if (part_.records > largest_.records) std::swap(part_, largest_);
  losses_.records_left_out += part_.records;
  for (LoggedTrack* track : {&largest_.log.estimate, &largest_.log.gnss, &largest_.log.truth}) sort_by_time(*track);
  take_ranges(largest_);
  VehicleLog log = std::move(largest_.log);
  log.format = format_;
  log.losses = losses_;
  sort_by_time(log.heights);
  sort_by_time(log.captures);
  return log;
}

}  // namespace pilotage
