#include "flight.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kSilence_s = 1;     // of the IMU, after which nobody knows what was flown
constexpr double kStartAge_s = 0.3;  // of attitude and position from which a flight begins
constexpr double kRangeAge_s = 1;
constexpr double kTerrainAge_s = 3;
constexpr double kAssumedGnssSigma_m = 5;  // of a receiver that does not say
constexpr double kClockDrift = 1e-4;       // of two crystals
constexpr std::int64_t kSecond_us = 1'000'000;

// Places of members on the wire: by size, then in the order of the definition.
double stamp_s(const mavlink::Message& message) {
  if (message.id == mavlink::kHighresImu) return static_cast<double>(message.at<std::uint64_t>(0)) / 1e6;
  return message.at<std::uint32_t>(0) / 1e3;
}
Eigen::Vector3d acceleration_mps2(const mavlink::Message& imu) {
  return {imu.at<float>(8), imu.at<float>(12), imu.at<float>(16)};
}
Eigen::Vector3d rate_radps(const mavlink::Message& imu) {
  return {imu.at<float>(20), imu.at<float>(24), imu.at<float>(28)};
}
double pressure_altitude_m(const mavlink::Message& imu) {
  return imu.at<float>(52);
}
bool has_pressure_altitude(const mavlink::Message& imu) {
  return (imu.at<std::uint16_t>(60) & (1 << 11)) != 0;
}
pilotage::Attitude attitude_deg(const mavlink::Message& attitude) {
  const double roll = attitude.at<float>(4), pitch = attitude.at<float>(8), yaw = attitude.at<float>(12);
  return {yaw * kDegrees, pitch * kDegrees, roll * kDegrees};
}
pilotage::GeodeticPoint point_of(const mavlink::Message& position) {
  return {position.at<std::int32_t>(8) / 1e7, position.at<std::int32_t>(4) / 1e7};
}
double amsl_m(const mavlink::Message& position) {
  return position.at<std::int32_t>(12) / 1e3;
}
Eigen::Vector3d velocity_enu_mps(const mavlink::Message& position) {
  const double north = position.at<std::int16_t>(20), east = position.at<std::int16_t>(22),
               down = position.at<std::int16_t>(24);
  return Eigen::Vector3d(east, north, -down) / 100;
}
bool has_gnss_fix(const mavlink::Message& gnss) {
  return gnss.at<std::uint8_t>(28) >= 3;
}
double gnss_sigma_m(const mavlink::Message& gnss) {
  const double said_m = gnss.at<std::uint32_t>(34) / 1e3;  // 0: the receiver does not say
  return said_m > 0 ? said_m : kAssumedGnssSigma_m;
}

std::string text_of(const char* format, double number) {
  std::string text(60, '\0');
  text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), format, number)));
  return text;
}

/// East, north or up of a place, along Earth-fixed axes.
Eigen::Vector3d up_at(const pilotage::GeodeticPoint& point) {
  const double lon = point.lon_deg / kDegrees, lat = point.lat_deg / kDegrees;
  return {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)};
}

/// A point so many metres away: for some metres, not for kilometres.
pilotage::GeodeticPoint moved(const pilotage::GeodeticPoint& point, const Eigen::Vector2d& east_north_m) {
  constexpr double kRadius_m = 6371000;
  return {pilotage::wrap_lon_deg(point.lon_deg +
                                 east_north_m.x() / (kRadius_m * std::cos(point.lat_deg / kDegrees)) * kDegrees),
          point.lat_deg + east_north_m.y() / kRadius_m * kDegrees};
}

}  // namespace

Flight::Flight(const FlightOptions& options, std::optional<double> map_sigma_m, Send send)
    : options_(options), send_(std::move(send)), sender_(options.sender) {
  if (map_sigma_m) {  // a captured map: off everywhere alike
    navigation_.map_sigma_m = *map_sigma_m;
    navigation_.map_correlation_m = 1e6;
  }
}

// ---- Clocks ----
// A stamp is older than its arrival by the way it took, which is never less than nothing: the least difference is the
// clocks' own, but for the shortest way.
void Flight::set_clock(double stamp_s, std::int64_t now_us) {
  const double offset_us = static_cast<double>(now_us) - stamp_s * 1e6;
  if (!clock_offset_us_) {
    clock_offset_us_ = offset_us;
  } else {
    const double passed_us = static_cast<double>(now_us - clock_set_us_);
    clock_offset_us_ = std::min(*clock_offset_us_ + kClockDrift * passed_us, offset_us);
  }
  clock_set_us_ = now_us;
}

double Flight::autopilot_time_s(std::int64_t time_us) const {
  return (static_cast<double>(time_us) - clock_offset_us_.value_or(0)) / 1e6;
}

// ---- What is heard ----
void Flight::hear(const mavlink::Message& message, std::int64_t now_us) {
  constexpr std::uint8_t kAutopilotComponent = 1;
  if (message.component_id != kAutopilotComponent || (autopilot_ != 0 && message.system_id != autopilot_)) return;
  if (message.id == mavlink::kHeartbeat) {
    autopilot_ = message.system_id;
    return;
  }
  if (autopilot_ == 0) return;
  switch (message.id) {
    case mavlink::kHighresImu:
      hear_imu(message, now_us);
      break;
    case mavlink::kAttitude:
      attitude_ = Timed{stamp_s(message), message};
      break;
    case mavlink::kGlobalPositionInt:
      position_ = Timed{stamp_s(message), message};
      break;
    case mavlink::kGpsRawInt:
      gnss_ = Timed{autopilot_time_s(now_us), message};
      break;
    case mavlink::kDistanceSensor: {
      constexpr std::uint8_t kDown = 25;  // MAV_SENSOR_ROTATION_PITCH_270
      const double least_cm = message.at<std::uint16_t>(4), most_cm = message.at<std::uint16_t>(6);
      const double range_cm = message.at<std::uint16_t>(8);
      if (message.at<std::uint8_t>(12) != kDown || range_cm <= least_cm || range_cm >= most_cm || !attitude_) break;
      const pilotage::Attitude attitude = attitude_deg(attitude_->message);
      const double upright = std::cos(attitude.pitch_deg / kDegrees) * std::cos(attitude.roll_deg / kDegrees);
      range_ = {stamp_s(message), range_cm / 100 * upright};
      break;
    }
    case mavlink::kTerrainReport: {
      const bool is_known = message.at<std::uint16_t>(16) != 0;  // the spacing of its grid
      if (is_known) terrain_ = {autopilot_time_s(now_us), message.at<float>(12)};
      break;
    }
    case mavlink::kCommandAck:
      hear_acknowledgement(message, now_us);
      break;
    default:
      break;
  }
}

void Flight::hear_acknowledgement(const mavlink::Message& message, std::int64_t now_us) {
  if (message.at<std::uint16_t>(0) != mavlink::kExternalPositionEstimate) return;
  const int result = message.at<std::uint8_t>(2);
  if (result == 0) return;
  ++rejected_commands_;
  say(mavlink::kWarning, "autopilot refuses positions, MAV_RESULT " + std::to_string(result), now_us);
}

void Flight::hear_imu(const mavlink::Message& message, std::int64_t now_us) {
  const double time_s = stamp_s(message);
  if (message.at<std::uint8_t>(62) != 0) return;  // one IMU, the first
  set_clock(time_s, now_us);
  if (!imu_.empty() && time_s <= imu_.back().time_s) return;
  imu_.push_back({time_s, message});
}

// ---- Flying ----
void Flight::try_to_start(double time_s, double pressure_altitude_m) {
  const auto is_fresh = [&](const std::optional<Timed>& heard, double age_s) {
    return heard && std::abs(time_s - heard->time_s) <= age_s;
  };
  if (!is_fresh(attitude_, kStartAge_s) || !is_fresh(position_, kStartAge_s)) return;
  pilotage::InsOptions ins;
  ins.grade = options_.ins_grade;
  pilotage::InsErrorModel model = pilotage::make_ins_error_model(ins);
  if (options_.start_sigma_m) {
    model.start_sigma_m = *options_.start_sigma_m;
  } else {
    // The autopilot's position is believed while a receiver is behind it, and no better than that one says.
    if (!is_fresh(gnss_, kTerrainAge_s) || !has_gnss_fix(gnss_->message)) return;
    model.start_sigma_m = std::max(model.start_sigma_m, gnss_sigma_m(gnss_->message));
  }
  const Eigen::Vector3d velocity = velocity_enu_mps(position_->message);
  const double ahead_s = time_s - position_->time_s;
  const pilotage::GeodeticPoint place = moved(point_of(position_->message), velocity.head<2>() * ahead_s);
  const double height_m = amsl_m(position_->message) + velocity.z() * ahead_s;
  pressure_offset_m_ = pressure_altitude_m - height_m;
  // Heights here are above mean sea level all along. That they are not above the ellipsoid turns 100 m into an error of
  // gravity and curvature of 3 in 100,000.
  filter_.emplace(model, navigation_,
                  pilotage::inertial_state(time_s, place, height_m, velocity, attitude_deg(attitude_->message)));
}

void Flight::advance(const mavlink::Message& imu) {
  const double time_s = stamp_s(imu);
  const double dt_s = time_s - flown_s_;
  flown_s_ = time_s;
  if (!filter_) {
    if (broken_) return;
    if (has_pressure_altitude(imu)) try_to_start(time_s, pressure_altitude_m(imu));
    return;
  }
  if (dt_s > kSilence_s || !filter_->advance({dt_s, rate_radps(imu) * dt_s, acceleration_mps2(imu) * dt_s})) {
    filter_.reset();
    broken_ = true;
    return;
  }
  if (has_pressure_altitude(imu)) filter_->take_height(pressure_altitude_m(imu) - pressure_offset_m_);
}

void Flight::advance_to(double time_s) {
  while (!imu_.empty() && imu_.front().time_s <= time_s) {
    advance(imu_.front().message);
    imu_.pop_front();
  }
}

std::optional<double> Flight::height_agl_m() const {
  if (flown_s_ - range_.time_s <= kRangeAge_s) return range_.agl_m;
  if (flown_s_ - terrain_.time_s <= kTerrainAge_s) return terrain_.agl_m;
  if (options_.ground_amsl_m) return filter_->estimate().height_m - *options_.ground_amsl_m;
  return std::nullopt;
}

double Flight::height_sigma_m() {
  const Eigen::Vector3d up = up_at(filter_->estimate().position);
  constexpr int kAt = pilotage::NavigationErrors::kPosition;
  return std::sqrt(std::max(0.0, up.dot(filter_->covariance().block<3, 3>(kAt, kAt) * up)));
}

// ---- Frames ----
bool Flight::may_begin(std::int64_t exposure_us, std::int64_t now_us) const {
  const bool is_flown_past = !imu_.empty() && imu_.back().time_s >= autopilot_time_s(exposure_us);
  return is_flown_past || static_cast<double>(now_us - exposure_us) > options_.hold_back_s * 1e6;
}

std::optional<MatchTask> Flight::begin(std::int64_t exposure_us) {
  const double exposure_s = autopilot_time_s(exposure_us);
  advance_to(exposure_s);
  if (!filter_) {
    ++skipped_;
    return std::nullopt;
  }
  // The state is that of the last increment before the exposure, and none of a later one.
  const double behind_s = exposure_s - flown_s_;
  if (behind_s < 0 || behind_s > options_.hold_back_s) {
    ++late_;
    return std::nullopt;
  }
  const auto agl_m = height_agl_m();
  if (!agl_m) {
    ++without_height_;
    return std::nullopt;
  }
  MatchTask task;
  task.frame = filter_->take_frame();
  task.exposure_us = exposure_us;
  const auto prior = filter_->match_prior(task.frame, *agl_m);
  if (!prior) return std::nullopt;
  task.prior = *prior;
  const Eigen::Vector3d up = up_at(prior->position);
  constexpr int kAt = pilotage::NavigationErrors::kAttitude;
  const Eigen::Matrix3d attitude_rad2 = filter_->covariance().block<3, 3>(kAt, kAt);
  const double yaw_rad2 = up.dot(attitude_rad2 * up);
  task.options.yaw_sigma_deg = std::clamp(std::sqrt(yaw_rad2) * kDegrees, task.options.yaw_sigma_deg, 180.0);
  const double tilt_rad2 = (attitude_rad2.trace() - yaw_rad2) / 2;
  task.options.attitude_sigma_deg = std::clamp(std::sqrt(tilt_rad2) * kDegrees, task.options.attitude_sigma_deg, 20.0);
  ++tried_;
  return task;
}

void Flight::end(const MatchTask& task, const pilotage::MatchResult& result, std::int64_t now_us) {
  if (!result.fix || !filter_) {
    ++without_fix_[result.fix ? "no_imu" : std::string(match_status_name(result.status))];
    if (options_.sends_global_position_sensor) send_fix(task, {}, now_us);
    return;
  }
  const pilotage::PositionMeasurement measured = pilotage::without_prior(*result.fix, task.prior);
  const pilotage::FixUpdate update = filter_->take_fix(task.frame, measured);
  if (update.outcome != pilotage::FixOutcome::kTaken && update.outcome != pilotage::FixOutcome::kReset) {
    ++refused_;
    say(mavlink::kWarning, text_of("fix refused, %.0f m off", update.innovation_m.norm()), now_us);
    return;
  }
  ++taken_;
  // The autopilot has a filter of its own, which did not give the prior: it gets what the frame alone says.
  pilotage::MatchResult alone = result;
  alone.fix->position = measured.position;
  alone.fix->covariance_en_m2 = measured.covariance_en_m2;
  send_fix(task, alone, now_us);
  say(mavlink::kNotice,
      text_of("position by sight, sigma %.1f m", pilotage::largest_sigma_m(filter_->estimate().covariance_en_m2)),
      now_us);
}

void Flight::send_fix(const MatchTask& task, const pilotage::MatchResult& fix, std::int64_t now_us) {
  if (options_.sends_global_position_sensor) {
    pilotage::FixAltitude altitude;
    if (fix.fix) {
      altitude.amsl_m = filter_->estimate().height_m;
      altitude.sigma_m = height_sigma_m();
    }
    pilotage::MavlinkSending sending;
    sending.target_system = autopilot_;
    sending.sensor_id = static_cast<std::uint8_t>(options_.sensor_id);
    sending.exposure_time_us = static_cast<std::uint64_t>(task.exposure_us);
    sending.sending_time_us = static_cast<std::uint64_t>(now_us);
    send_(mavlink::global_position_sensor(sender_, pilotage::mavlink_global_position_sensor(fix, altitude, sending)));
  }
  // Autopilots refuse it while they have positions of another kind.
  const bool is_wanted = !options_.sends_gps_input || gps_input_is_over_;
  if (options_.sends_external_position_estimate && fix.fix && is_wanted) {
    constexpr std::uint8_t kAutopilotComponent = 1;
    send_(mavlink::external_position_estimate(
        sender_, {autopilot_, kAutopilotComponent, static_cast<double>(now_us - started_us_) / 1e6,
                  static_cast<double>(now_us - task.exposure_us) / 1e6,
                  pilotage::largest_sigma_m(fix.fix->covariance_en_m2), fix.fix->position}));
  }
}

// ---- What is due ----
void Flight::go_on(std::int64_t now_us) {
  if (started_us_ == 0) started_us_ = now_us;
  if (now_us >= next_heartbeat_us_) {
    send_(mavlink::heartbeat(sender_));
    next_heartbeat_us_ = now_us + kSecond_us;
  }
  if (autopilot_ == 0) return;
  if (now_us >= next_request_us_ && imu_.empty()) {
    for (const auto& [id, rate_hz] :
         std::vector<std::pair<std::uint32_t, double>>{{mavlink::kHighresImu, options_.imu_rate_hz},
                                                       {mavlink::kAttitude, 20},
                                                       {mavlink::kGlobalPositionInt, 10},
                                                       {mavlink::kGpsRawInt, 2},
                                                       {mavlink::kDistanceSensor, 10},
                                                       {mavlink::kTerrainReport, 2}}) {
      send_(mavlink::message_interval(sender_, autopilot_, id, rate_hz));
    }
    next_request_us_ = now_us + 5 * kSecond_us;
  }
  const bool was_broken = broken_, was_flying = filter_.has_value();
  advance_to(autopilot_time_s(now_us) - options_.hold_back_s);
  const double silent_s = autopilot_time_s(now_us) - options_.hold_back_s - flown_s_;
  if (filter_ && silent_s > kSilence_s) {
    filter_.reset();
    broken_ = true;
  }
  if (broken_ && !was_broken) say(mavlink::kWarning, "no IMU for a second: start again with GNSS", now_us);
  if (filter_ && !was_flying) say(mavlink::kNotice, "navigation by sight has begun", now_us);
  if (options_.sends_gps_input && now_us >= next_gps_input_us_) {
    send_gps_input(now_us);
    const auto period_us = static_cast<std::int64_t>(1e6 / options_.rate_hz);
    next_gps_input_us_ = std::max(next_gps_input_us_ + period_us, now_us - period_us);
  }
}

void Flight::send_gps_input(std::int64_t now_us) {
  mavlink::GpsInput input;
  input.time_us = static_cast<std::uint64_t>(now_us);
  input.gps_id = static_cast<std::uint8_t>(options_.sensor_id);
  if (filter_) {
    const pilotage::NavigationEstimate estimate = filter_->estimate();
    const double ahead_s = autopilot_time_s(now_us) - estimate.time_s;
    input.position = moved(estimate.position, estimate.velocity_enu_mps.head<2>() * ahead_s);
    input.amsl_m = estimate.height_m + estimate.velocity_enu_mps.z() * ahead_s;
    input.horizontal_sigma_m = pilotage::largest_sigma_m(estimate.covariance_en_m2);
    input.vertical_sigma_m = height_sigma_m();
    input.has_fix = input.horizontal_sigma_m <= options_.max_sigma_m && !gps_input_is_over_;
    if (!input.has_fix) say(mavlink::kWarning, text_of("no position: sigma %.0f m", input.horizontal_sigma_m), now_us);
  }
  if (gps_input_is_over(input.has_fix, now_us)) input.has_fix = false;
  send_(mavlink::gps_input(sender_, input));
}

/// ArduPilot sets its velocity anew after seven seconds without a position (EKF3, posRetryTimeNoVel_ms), from the
/// message that ends them: to zero, for want of one. So there is no second beginning.
bool Flight::gps_input_is_over(bool has_fix, std::int64_t now_us) {
  constexpr std::int64_t kLongest_us = 5 * kSecond_us;
  if (!gps_input_is_over_ && gps_input_fix_us_ != 0 && now_us - gps_input_fix_us_ > kLongest_us) {
    gps_input_is_over_ = true;
    say(mavlink::kWarning, "GPS_INPUT is over after 5 s without", now_us);
  }
  if (has_fix && !gps_input_is_over_) gps_input_fix_us_ = now_us;
  return gps_input_is_over_;
}

/// What is new at once, what was said last every ten seconds.
void Flight::say(std::uint8_t severity, const std::string& text, std::int64_t now_us) {
  const std::string subject = text.substr(0, text.find_first_of("0123456789"));
  if (subject == said_ && now_us < said_us_ + 10 * kSecond_us) return;
  said_ = subject;
  said_us_ = now_us;
  send_(mavlink::statustext(sender_, severity, "Pilotage: " + text));
}

std::string Flight::summary() const {
  std::string text = std::to_string(tried_) + " frames tried, " + std::to_string(taken_) + " fixes taken, " +
                     std::to_string(refused_) + " refused by the filter";
  for (const auto& [status, count] : without_fix_) text += ", " + std::to_string(count) + " " + status;
  if (skipped_ > 0) text += ", " + std::to_string(skipped_) + " skipped";
  if (late_ > 0) text += ", " + std::to_string(late_) + " later than the hold-back";
  if (without_height_ > 0) text += ", " + std::to_string(without_height_) + " without a height above ground";
  if (rejected_commands_ > 0) text += "; the autopilot refused " + std::to_string(rejected_commands_) + " positions";
  return text;
}
