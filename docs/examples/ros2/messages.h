// Fixes into messages of ROS 2, for any type that has the message's members: those that rosidl makes, or a stand-in.
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>

#include <pilotage/onboard.h>

namespace pilotage_ros {

/// Nanoseconds since 1970 of builtin_interfaces/Time.
template <class Time>
std::int64_t nanoseconds_of(const Time& time) {
  return std::int64_t{time.sec} * 1'000'000'000 + time.nanosec;
}

/// sensor_msgs/Imu has the turn of the body (x forward, y left, z up) against east, north, up (REP 103); here it is yaw
/// clockwise from north, pitch with the nose up, roll with the right wing down.
template <class Quaternion>
pilotage::Attitude attitude_of(const Quaternion& turn) {
  constexpr double kDegrees = 180 / std::numbers::pi;
  const double w = turn.w, x = turn.x, y = turn.y, z = turn.z;
  // Where the nose points, and how high the left wing and the roof are.
  const double nose_east = 1 - 2 * (y * y + z * z), nose_north = 2 * (x * y + w * z), nose_up = 2 * (x * z - w * y);
  const double left_up = 2 * (y * z + w * x), roof_up = 1 - 2 * (x * x + y * y);
  const double yaw_deg = std::atan2(nose_east, nose_north) * kDegrees;
  return {yaw_deg < 0 ? yaw_deg + 360 : yaw_deg, std::asin(std::clamp(nose_up, -1.0, 1.0)) * kDegrees,
          std::atan2(left_up, roof_up) * kDegrees};
}

/// sensor_msgs/NavSatFix
template <class Message>
void set_nav_sat_fix(const pilotage::NavSatFix& fix, Message& message) {
  message.header.stamp.sec = fix.stamp_sec;
  message.header.stamp.nanosec = fix.stamp_nanosec;
  message.header.frame_id = fix.frame_id;
  message.status.status = fix.status;
  message.status.service = fix.service;
  message.latitude = fix.latitude;
  message.longitude = fix.longitude;
  message.altitude = fix.altitude;
  std::copy(fix.position_covariance.begin(), fix.position_covariance.end(), message.position_covariance.begin());
  message.position_covariance_type = fix.position_covariance_type;
}

/// px4_msgs/AuxGlobalPosition; only for a fix. Times are µs of ROS's clock, which PX4's client of DDS brings onto its
/// own (UXRCE_DDS_SYNCT); PX4 takes timestamp_sample for the time of the position, so no delay need be told.
template <class Message>
void set_aux_global_position(const pilotage::MatchResult& result, const pilotage::FixAltitude& altitude,
                             std::int64_t exposure_time_ns, std::int64_t now_ns, int id, Message& message) {
  constexpr std::uint8_t kVision = 2;  // SOURCE_VISION
  message.timestamp = static_cast<std::uint64_t>(now_ns / 1000);
  message.timestamp_sample = static_cast<std::uint64_t>(exposure_time_ns / 1000);
  message.id = static_cast<std::uint8_t>(id);
  message.source = kVision;
  message.lat = result.fix->position.lat_deg;
  message.lon = result.fix->position.lon_deg;
  message.alt = static_cast<float>(altitude.amsl_m);
  message.eph = static_cast<float>(pilotage::largest_sigma_m(result.fix->covariance_en_m2));
  message.epv = static_cast<float>(altitude.sigma_m);
  message.lat_lon_reset_counter = 0;
}

/// diagnostic_msgs/DiagnosticStatus: what became of a picture, and why.
template <class Message>
void set_diagnostic(const pilotage::MatchResult& result, std::chrono::duration<double> took, Message& message) {
  const auto add = [&message](const std::string& key, double number) {
    auto& value = message.values.emplace_back();
    value.key = key;
    value.value = std::to_string(number);
  };
  message.level = result.fix ? Message::OK : Message::WARN;
  message.name = "pilotage: position by sight";
  message.message = std::string(pilotage::match_status_name(result.status)) + ": " +
                    std::string(pilotage::match_status_text(result.status));
  add("inliers", result.stats.inliers);
  add("confidence", result.stats.confidence);
  if (result.fix) add("sigma_m", pilotage::largest_sigma_m(result.fix->covariance_en_m2));
  add("took_ms", took.count() * 1e3);
}

}  // namespace pilotage_ros
