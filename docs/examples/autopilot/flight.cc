#include "flight.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numbers>
#include <utility>
#include <vector>

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kHole_s = 0.2;         // in the increments: a longer one is not flown as if nothing had changed
constexpr double kSilence_s = 3;        // of the IMU, after which nobody knows where the aircraft went
constexpr double kUnknown_mps2 = 5;     // acceleration that nobody measured: half a g
constexpr double kSteady_radps = 0.17;  // ten degrees a second: an attitude 0.1 s old is a degree off
constexpr double kAttitudeAge_s = 0.1;
constexpr double kPositionAge_s = 0.3;
constexpr double kGnssAge_s = 2;
constexpr double kRangeAge_s = 1;
constexpr double kTerrainAge_s = 3;
constexpr double kTerrainReach_m = 200;  // of the place that a terrain report is of
constexpr double kAlignEach_s = 1;
constexpr double kAlignAtLast_s = 5;
constexpr double kHistory_s = 3;
constexpr double kAssumedGnssSigma_m = 5;  // of a receiver that does not say
constexpr double kGnssAgreement_m = 50;    // of the autopilot's position and its receiver's
constexpr double kClockDrift = 1e-4;       // of two crystals
constexpr double kClockStep_us = 1e6;      // more is another clock: the autopilot began anew
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
pilotage::GeodeticPoint gnss_point(const mavlink::Message& gnss) {
  return {gnss.at<std::int32_t>(12) / 1e7, gnss.at<std::int32_t>(8) / 1e7};
}
double gnss_sigma_m(const mavlink::Message& gnss) {
  const double said_m = gnss.at<std::uint32_t>(34) / 1e3;  // 0: the receiver does not say
  return said_m > 0 ? said_m : kAssumedGnssSigma_m;
}

pilotage::InsErrorModel error_model(pilotage::InsGrade grade) {
  pilotage::InsOptions ins;
  ins.grade = grade;
  return pilotage::make_ins_error_model(ins);
}

std::string text_of(const char* format, double number) {
  std::string text(60, '\0');
  text.resize(static_cast<std::size_t>(std::snprintf(text.data(), text.size(), format, number)));
  return text;
}

/// Up at a place, along Earth-fixed axes.
Eigen::Vector3d up_at(const pilotage::GeodeticPoint& point) {
  const double lon = point.lon_deg / kDegrees, lat = point.lat_deg / kDegrees;
  return {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)};
}

constexpr double kEarthRadius_m = 6371000;

/// For some kilometres.
double distance_m(const pilotage::GeodeticPoint& a, const pilotage::GeodeticPoint& b) {
  const double east = pilotage::wrap_lon_deg(b.lon_deg - a.lon_deg) / kDegrees * std::cos(a.lat_deg / kDegrees);
  return kEarthRadius_m * std::hypot(east, (b.lat_deg - a.lat_deg) / kDegrees);
}

/// A point so many metres away: for some metres, not for kilometres.
pilotage::GeodeticPoint moved(const pilotage::GeodeticPoint& point, const Eigen::Vector2d& east_north_m) {
  return {pilotage::wrap_lon_deg(point.lon_deg +
                                 east_north_m.x() / (kEarthRadius_m * std::cos(point.lat_deg / kDegrees)) * kDegrees),
          point.lat_deg + east_north_m.y() / kEarthRadius_m * kDegrees};
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
  if (clock_offset_us_ && std::abs(offset_us - *clock_offset_us_) > kClockStep_us + (kSilence_s * 1e6)) begin_anew();
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

/// Nothing that was heard by another clock counts.
void Flight::begin_anew() {
  clock_offset_us_.reset();
  imu_.clear();
  attitudes_.clear();
  positions_.clear();
  gnss_.reset();
  range_.reset();
  terrain_.reset();
  stamp_s_ = flown_stamp_s_ = -1e9;
  lose();
}

// ---- What is heard ----
void Flight::hear(const mavlink::Message& message, std::int64_t now_us) {
  if (message.component_id != mavlink::kAutopilotComponent || message.system_id != sender_.system_id) return;
  is_there_ = true;
  heard_us_[message.id] = now_us;
  const auto remember = [](std::deque<Timed>& history, Timed one) {
    history.push_back(std::move(one));
    while (history.front().time_s < history.back().time_s - kHistory_s) history.pop_front();
  };
  switch (message.id) {
    case mavlink::kHighresImu:
      hear_imu(message, now_us);
      break;
    case mavlink::kAttitude:
      remember(attitudes_, {stamp_s(message), message});
      break;
    case mavlink::kGlobalPositionInt:
      remember(positions_, {stamp_s(message), message});
      break;
    case mavlink::kGpsRawInt:
      gnss_ = Timed{autopilot_time_s(now_us), message};
      break;
    case mavlink::kDistanceSensor:
      hear_range(message);
      break;
    case mavlink::kTerrainReport: {
      const bool is_known = message.at<std::uint16_t>(16) != 0;  // the spacing of its grid
      if (is_known && is_of_own_place(message)) terrain_ = Timed{autopilot_time_s(now_us), message};
      break;
    }
    case mavlink::kCommandAck:
      hear_acknowledgement(message, now_us);
      break;
    default:
      break;
  }
}

/// A terrain report may be of the autopilot's place, which may be another.
bool Flight::is_of_own_place(const mavlink::Message& terrain) const {
  const pilotage::GeodeticPoint place = {terrain.at<std::int32_t>(4) / 1e7, terrain.at<std::int32_t>(0) / 1e7};
  return filter_ && distance_m(place, filter_->estimate().position) < kTerrainReach_m;
}

void Flight::hear_range(const mavlink::Message& message) {
  constexpr std::uint8_t kDown = 25;    // MAV_SENSOR_ROTATION_PITCH_270
  constexpr std::uint8_t kInvalid = 1;  // of signal_quality
  const int least_cm = message.at<std::uint16_t>(4), most_cm = message.at<std::uint16_t>(6);
  const int range_cm = message.at<std::uint16_t>(8);
  if (message.at<std::uint8_t>(12) != kDown || message.at<std::uint8_t>(38) == kInvalid) return;
  if (range_cm > least_cm && range_cm < most_cm) range_ = Timed{stamp_s(message), message};
}

void Flight::hear_acknowledgement(const mavlink::Message& message, std::int64_t now_us) {
  if (message.at<std::uint16_t>(0) != mavlink::kExternalPositionEstimate) return;
  const int result = message.at<std::uint8_t>(2);
  if (result == 0) return;
  ++rejected_commands_;
  say(mavlink::kWarning, "43003 is refused, MAV_RESULT " + std::to_string(result), now_us);
}

/// Of the first IMU that is heard; of another when that one is silent.
void Flight::hear_imu(const mavlink::Message& message, std::int64_t now_us) {
  const double time_s = stamp_s(message);
  const int id = message.at<std::uint8_t>(62);
  if (imu_id_ >= 0 && id != imu_id_ && std::abs(time_s - stamp_s_) < kHole_s) return;
  imu_id_ = id;
  set_clock(time_s, now_us);
  if (time_s <= stamp_s_) return;
  stamp_s_ = time_s;
  imu_.push_back({time_s, message});
}

// ---- Flying ----
/// Whether the autopilot's position may be believed: a receiver is behind it, and says the same. Not after a fix by
/// sight.
bool Flight::may_align() const {
  if (has_sighted_) return false;
  if (options_.start_sigma_m) return !has_started_;
  // A frame in the matcher would be lost, but there may always be one.
  if (unanswered_ > 0 && flown_s_ - aligned_s_ < kAlignAtLast_s) return false;
  if (!gnss_ || std::abs(flown_s_ - gnss_->time_s) > kGnssAge_s || !has_gnss_fix(gnss_->message)) return false;
  if (filter_ && flown_s_ - aligned_s_ < kAlignEach_s) return false;
  return !positions_.empty() && gnss_disagreement_m() < kGnssAgreement_m;
}

/// How far the autopilot's position is from its receiver's, beyond what it flew between the two.
double Flight::gnss_disagreement_m() const {
  const mavlink::Message& position = positions_.back().message;
  const double flown_m = velocity_enu_mps(position).norm() * std::abs(positions_.back().time_s - gnss_->time_s);
  return std::max(0.0, distance_m(point_of(position), gnss_point(gnss_->message)) - flown_m);
}

/// The filter begins with what the autopilot believes at the time of this increment, unless the aircraft turns.
void Flight::align(const mavlink::Message& imu) {
  const auto latest = [this](const std::deque<Timed>& history, double age_s) -> const mavlink::Message* {
    const auto after =
        std::find_if(history.begin(), history.end(), [&](const Timed& one) { return one.time_s > flown_s_; });
    if (after == history.begin() || flown_s_ - std::prev(after)->time_s > age_s) return nullptr;
    return &std::prev(after)->message;
  };
  const mavlink::Message* attitude = latest(attitudes_, kAttitudeAge_s);
  const mavlink::Message* position = latest(positions_, kPositionAge_s);
  if (attitude == nullptr || position == nullptr || rate_radps(imu).norm() > kSteady_radps) return;
  pilotage::InsErrorModel model = error_model(options_.ins_grade);
  model.start_sigma_m =
      options_.start_sigma_m
          ? *options_.start_sigma_m
          : std::max(model.start_sigma_m, std::hypot(gnss_sigma_m(gnss_->message), gnss_disagreement_m()));
  const Eigen::Vector3d velocity = velocity_enu_mps(*position);
  const double ahead_s = flown_s_ - stamp_s(*position);
  const pilotage::GeodeticPoint place = point_of(*position);
  if (place.lon_deg == 0 && place.lat_deg == 0) return;  // what autopilots say that do not know
  pressure_altitude_m_ = pressure_altitude_m(imu);
  const double height_m = amsl_m(*position) + velocity.z() * ahead_s;
  pressure_offset_m_ = pressure_altitude_m_ - height_m;
  aligned_s_ = flown_s_;
  has_started_ = true;
  if (!options_.start_sigma_m) {  // the autopilot has GNSS, and its velocity
    gps_input_is_over_ = false;
    gps_input_fix_us_ = 0;
  }
  start(model, moved(place, velocity.head<2>() * ahead_s), height_m, velocity, attitude_deg(*attitude));
}

/// Heights here are above mean sea level all along. That they are not above the ellipsoid turns 100 m into an error of
/// gravity and curvature of 3 in 100,000.
void Flight::start(const pilotage::InsErrorModel& model, const pilotage::GeodeticPoint& place, double height_m,
                   const Eigen::Vector3d& velocity, const pilotage::Attitude& attitude) {
  ++filters_;
  unanswered_ = 0;
  hole_from_s_.reset();
  try {
    filter_.emplace(model, navigation_, pilotage::inertial_state(flown_s_, place, height_m, velocity, attitude));
  } catch (const pilotage::UsageError&) {  // numbers that are none
    filter_.reset();
  }
}

/// Increments are missing. It goes on where it was heading, with what it may have done meanwhile in its covariance, and
/// the attitude that the autopilot kept: as soon as one of this time has come.
void Flight::go_on_behind_hole(const mavlink::Message& imu) {
  const double hole_s = flown_s_ - *hole_from_s_;
  if (hole_s > kSilence_s) return lose();
  const auto nearest = std::min_element(attitudes_.begin(), attitudes_.end(), [this](const Timed& a, const Timed& b) {
    return std::abs(a.time_s - flown_s_) < std::abs(b.time_s - flown_s_);
  });
  if (nearest == attitudes_.end() || std::abs(nearest->time_s - flown_s_) > kAttitudeAge_s) return;
  const pilotage::NavigationEstimate before = filter_->estimate();
  constexpr int kAt = pilotage::NavigationErrors::kVelocity;
  // At least that of the worst direction.
  const double velocity_sigma_mps = std::sqrt(std::max(0.0, filter_->covariance().block<3, 3>(kAt, kAt).trace()));
  pilotage::InsErrorModel model = error_model(options_.ins_grade);
  model.start_sigma_m = pilotage::largest_sigma_m(before.covariance_en_m2) + velocity_sigma_mps * hole_s +
                        kUnknown_mps2 * hole_s * hole_s / 2;
  model.start_velocity_sigma_mps = velocity_sigma_mps + kUnknown_mps2 * hole_s;
  // The attitude may be so much older or newer than this increment.
  const double turned_rad = rate_radps(imu).norm() * kAttitudeAge_s;
  model.start_tilt_sigma_rad += turned_rad;
  model.start_heading_sigma_rad += turned_rad;
  start(model, moved(before.position, before.velocity_enu_mps.head<2>() * hole_s),
        before.height_m + before.velocity_enu_mps.z() * hole_s, before.velocity_enu_mps,
        attitude_deg(nearest->message));
}

/// Where the aircraft is, is not known any more. Before the first fix by sight it may align again.
void Flight::lose() {
  if (filter_ && has_sighted_) is_lost_ = true;
  filter_.reset();
  ++filters_;  // what the matcher still answers is nobody's
  unanswered_ = 0;
}

void Flight::advance(const mavlink::Message& imu) {
  const double stamp = stamp_s(imu);
  const bool is_hole = stamp - flown_stamp_s_ > kHole_s;
  const double dt_s = stamp - flown_s_;
  if (filter_ && is_hole && !hole_from_s_) hole_from_s_ = flown_s_;
  flown_s_ = flown_stamp_s_ = stamp;
  if (is_lost_) return;
  if (filter_ && hole_from_s_) {
    go_on_behind_hole(imu);
  } else if (filter_ && !filter_->advance({dt_s, rate_radps(imu) * dt_s, acceleration_mps2(imu) * dt_s})) {
    lose();
  }
  if (!has_pressure_altitude(imu)) return;
  if (may_align()) align(imu);
  // One reading of the barometer comes in several messages.
  if (!filter_ || hole_from_s_ || pressure_altitude_m(imu) == pressure_altitude_m_) return;
  pressure_altitude_m_ = pressure_altitude_m(imu);
  filter_->take_height(pressure_altitude_m_ - pressure_offset_m_);
}

void Flight::advance_to(double time_s) {
  while (!imu_.empty() && imu_.front().time_s <= time_s) {
    advance(imu_.front().message);
    imu_.pop_front();
  }
}

/// To a time between two increments, of the later of which a part is flown. False where that one is not there.
bool Flight::advance_within(double time_s) {
  advance_to(time_s);
  const double dt_s = time_s - flown_s_;
  if (!filter_ || hole_from_s_ || dt_s < 0 || imu_.empty()) return false;
  const mavlink::Message& imu = imu_.front().message;
  if (imu_.front().time_s - flown_stamp_s_ > kHole_s) return false;
  if (dt_s > 0 && !filter_->advance({dt_s, rate_radps(imu) * dt_s, acceleration_mps2(imu) * dt_s})) return false;
  flown_s_ = time_s;
  return true;
}

std::optional<double> Flight::height_agl_m() const {
  const auto is_fresh = [this](const std::optional<Timed>& heard, double age_s) {
    return heard && std::abs(flown_s_ - heard->time_s) <= age_s;
  };
  const pilotage::NavigationEstimate estimate = filter_->estimate();
  if (is_fresh(range_, kRangeAge_s)) {
    const double upright =
        std::cos(estimate.attitude.pitch_deg / kDegrees) * std::cos(estimate.attitude.roll_deg / kDegrees);
    return range_->message.at<std::uint16_t>(8) / 100.0 * upright;
  }
  // The ground at our own place: the autopilot's may be another.
  if (is_fresh(terrain_, kTerrainAge_s)) {
    const double ground_amsl_m = terrain_->message.at<float>(8);
    if (is_of_own_place(terrain_->message)) return estimate.height_m - ground_amsl_m;
  }
  if (options_.ground_amsl_m) return estimate.height_m - *options_.ground_amsl_m;
  return std::nullopt;
}

double Flight::height_sigma_m() {
  const Eigen::Vector3d up = up_at(filter_->estimate().position);
  constexpr int kAt = pilotage::NavigationErrors::kPosition;
  return std::sqrt(std::max(0.0, up.dot(filter_->covariance().block<3, 3>(kAt, kAt) * up)));
}

/// As if the velocity had stayed the same from the state to that time; σ has what that may be wrong.
Flight::Place Flight::place_at(double time_s) {
  const pilotage::NavigationEstimate estimate = filter_->estimate();
  const double ahead_s = time_s - estimate.time_s;
  return {moved(estimate.position, estimate.velocity_enu_mps.head<2>() * ahead_s),
          estimate.height_m + estimate.velocity_enu_mps.z() * ahead_s,
          std::hypot(pilotage::largest_sigma_m(estimate.covariance_en_m2), kUnknown_mps2 * ahead_s * ahead_s / 2)};
}

// ---- Frames ----
bool Flight::may_begin(std::int64_t exposure_us, std::int64_t now_us) const {
  const bool is_flown_past = !imu_.empty() && imu_.back().time_s > autopilot_time_s(exposure_us);
  return is_flown_past || static_cast<double>(now_us - exposure_us) > options_.hold_back_s * 1e6;
}

std::optional<MatchTask> Flight::begin(std::int64_t exposure_us, std::int64_t now_us) {
  MatchTask task;
  task.exposure_us = exposure_us;
  task.exposure_s = autopilot_time_s(exposure_us);
  const bool is_late = filter_ && task.exposure_s < flown_s_;
  if (is_late) say(mavlink::kWarning, "pictures come late: --hold-back-ms", now_us);
  if (is_late || !advance_within(task.exposure_s)) {
    skip(is_late ? "late" : is_lost_ ? "lost" : filter_ ? "without the IMU" : "before navigation began");
    return std::nullopt;
  }
  const auto agl_m = height_agl_m();
  if (!agl_m) {
    skip("without a height above ground");
    return std::nullopt;
  }
  task.filter = filters_;
  task.frame = filter_->take_frame();
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
  task.options.deadline_ms = options_.deadline_ms;
  ++unanswered_;
  ++tried_;
  return task;
}

void Flight::drop(const MatchTask& task) {
  if (task.filter == filters_) --unanswered_;
  --tried_;
  skip("for a later one");
}

void Flight::end(const MatchTask& task, const pilotage::MatchResult& result, std::int64_t now_us) {
  const bool is_known = filter_ && task.filter == filters_;
  if (is_known) --unanswered_;
  if (!result.fix || !is_known) {
    ++without_fix_[result.fix ? "of no use any more" : std::string(match_status_name(result.status))];
    return send_fix(task, {}, now_us);
  }
  const pilotage::PositionMeasurement measured = pilotage::without_prior(*result.fix, task.prior);
  const pilotage::FixUpdate update = filter_->take_fix(task.frame, measured);
  if (update.outcome == pilotage::FixOutcome::kRefused) {
    ++refused_;
    say(mavlink::kWarning, text_of("fix refused, %.0f m off", update.innovation_m.norm()), now_us);
  } else if (update.outcome != pilotage::FixOutcome::kTaken && update.outcome != pilotage::FixOutcome::kReset) {
    ++without_fix_["of no use any more"];
  } else {
    ++taken_;
    has_sighted_ = true;
    // The autopilot has a filter of its own, which did not give the prior: it gets what the frame alone says.
    pilotage::MatchResult alone = result;
    alone.fix->position = measured.position;
    alone.fix->covariance_en_m2 = measured.covariance_en_m2;
    send_fix(task, alone, now_us);
    say(mavlink::kNotice,
        text_of("fix by sight, sigma %.1f m", pilotage::largest_sigma_m(filter_->estimate().covariance_en_m2)), now_us);
    return;
  }
  send_fix(task, {}, now_us);
}

void Flight::send_fix(const MatchTask& task, const pilotage::MatchResult& fix, std::int64_t now_us) {
  if (options_.sends_global_position_sensor) {
    pilotage::FixAltitude altitude;
    if (fix.fix) {
      altitude.amsl_m = place_at(task.exposure_s).amsl_m;
      altitude.sigma_m = height_sigma_m();
    }
    pilotage::MavlinkSending sending;
    sending.target_system = sender_.system_id;
    sending.sensor_id = static_cast<std::uint8_t>(options_.sensor_id);
    sending.exposure_time_us = static_cast<std::uint64_t>(task.exposure_us);
    sending.sending_time_us = static_cast<std::uint64_t>(now_us);
    send_(mavlink::global_position_sensor(sender_, pilotage::mavlink_global_position_sensor(fix, altitude, sending)));
  }
  // An autopilot puts itself where this says, so it gets all that is known, not one frame's share. Autopilots refuse it
  // while they have positions of another kind.
  const bool is_wanted = !options_.sends_gps_input || gps_input_is_over_;
  if (options_.sends_external_position_estimate && fix.fix && is_wanted) {
    const Place place = place_at(task.exposure_s);
    if (place.sigma_m > options_.max_sigma_m) return;
    send_(mavlink::external_position_estimate(
        sender_, {static_cast<double>(now_us - started_us_) / 1e6, static_cast<double>(now_us - task.exposure_us) / 1e6,
                  place.sigma_m, place.position}));
  }
}

// ---- What is due ----
void Flight::go_on(std::int64_t now_us) {
  if (started_us_ == 0) started_us_ = now_us;
  if (now_us >= next_heartbeat_us_) {
    send_(mavlink::heartbeat(sender_));
    next_heartbeat_us_ = now_us + kSecond_us;
  }
  if (!is_there_) return;
  ask_for_messages(now_us);
  advance_to(autopilot_time_s(now_us) - options_.hold_back_s);
  const double silent_s = autopilot_time_s(now_us) - options_.hold_back_s - flown_s_;
  if (filter_ && silent_s > kSilence_s) lose();
  say_changes(now_us);
  if (filter_ && now_us >= next_terrain_us_) {
    send_(mavlink::terrain_check(sender_, filter_->estimate().position));
    next_terrain_us_ = now_us + kSecond_us;
  }
  if (options_.sends_gps_input && now_us >= next_gps_input_us_) {
    send_gps_input(now_us);
    const auto period_us = static_cast<std::int64_t>(1e6 / options_.rate_hz);
    next_gps_input_us_ = std::max(next_gps_input_us_ + period_us, now_us - period_us);
  }
}

/// Of what was not heard lately; at first of everything, for the rate.
void Flight::ask_for_messages(std::int64_t now_us) {
  if (now_us < next_request_us_) return;
  const bool is_first = next_request_us_ == 0;
  for (const auto& [id, rate_hz] :
       std::vector<std::pair<std::uint32_t, double>>{{mavlink::kHighresImu, options_.imu_rate_hz},
                                                     {mavlink::kAttitude, 20},
                                                     {mavlink::kGlobalPositionInt, 10},
                                                     {mavlink::kGpsRawInt, 2},
                                                     {mavlink::kDistanceSensor, 10}}) {
    const auto heard = heard_us_.find(id);
    if (!is_first && heard != heard_us_.end() && now_us - heard->second < 2 * kSecond_us) continue;
    send_(mavlink::message_interval(sender_, id, rate_hz));
  }
  next_request_us_ = now_us + 5 * kSecond_us;
}

void Flight::say_changes(std::int64_t now_us) {
  if (is_lost_ && !said_lost_) say(mavlink::kWarning, "no IMU: where it is, is not known", now_us);
  if (filter_ && !said_begun_) say(mavlink::kNotice, "navigation has begun", now_us);
  said_lost_ = is_lost_;
  said_begun_ = filter_.has_value();
}

void Flight::send_gps_input(std::int64_t now_us) {
  mavlink::GpsInput input;
  input.time_us = static_cast<std::uint64_t>(now_us);
  input.gps_id = static_cast<std::uint8_t>(options_.sensor_id);
  if (filter_) {
    const Place place = place_at(autopilot_time_s(now_us));
    input.position = place.position;
    input.amsl_m = place.amsl_m;
    input.horizontal_sigma_m = place.sigma_m;
    input.vertical_sigma_m = height_sigma_m();
    input.has_fix = place.sigma_m <= options_.max_sigma_m;
    if (!input.has_fix) say(mavlink::kWarning, text_of("no position: sigma %.0f m", place.sigma_m), now_us);
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

/// At most every ten seconds the same, but for its numbers.
void Flight::say(std::uint8_t severity, const std::string& text, std::int64_t now_us) {
  const std::string subject = text.substr(0, text.find_first_of("0123456789"));
  const auto said = said_us_.find(subject);
  if (said != said_us_.end() && now_us < said->second + 10 * kSecond_us) return;
  said_us_[subject] = now_us;
  send_(mavlink::statustext(sender_, severity, "Pilotage: " + text));
}

std::string Flight::summary() const {
  std::string text = std::to_string(tried_) + " frames tried, " + std::to_string(taken_) + " fixes taken, " +
                     std::to_string(refused_) + " refused by the filter";
  for (const auto& [status, count] : without_fix_) text += ", " + std::to_string(count) + " " + status;
  for (const auto& [why, count] : skipped_) text += "; not tried: " + std::to_string(count) + " " + why;
  if (rejected_commands_ > 0) text += "; the autopilot refused " + std::to_string(rejected_commands_) + " positions";
  return text;
}
