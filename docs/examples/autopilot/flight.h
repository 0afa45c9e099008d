// From what an autopilot says and what a camera shows to positions for the autopilot: the part of this program that
// knows neither sockets nor clocks, so that a recorded flight gives what it gave in the air.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "mavlink.h"
#include <pilotage/onboard.h>

struct FlightOptions {
  bool sends_gps_input = false;
  bool sends_external_position_estimate = false;
  bool sends_global_position_sensor = false;
  mavlink::Sender sender;          ///< Its system is the autopilot's.
  int sensor_id = 1;               ///< GPS_INPUT.gps_id, GLOBAL_POSITION_SENSOR.id
  double rate_hz = 10;             ///< Of GPS_INPUT.
  double max_sigma_m = 100;        ///< GPS_INPUT has no fix beyond it.
  double imu_rate_hz = 100;        ///< What the autopilot is asked for.
  double hold_back_s = 0.1;        ///< Frames that come later than this after their exposure are of no use.
  double camera_latency_s = 0.05;  ///< From exposure to the picture's first byte, for pictures that do not say.
  double deadline_ms = 1000;       ///< Of a match.
  pilotage::InsGrade ins_grade = pilotage::InsGrade::kConsumer;
  std::optional<double> ground_amsl_m;  ///< For aircraft without a rangefinder and a terrain model.
  std::optional<double> start_sigma_m;  ///< Start without GNSS: how far off the autopilot's position may be.
};

/// A frame on its way through the matcher.
struct MatchTask {
  pilotage::FrameNumber frame = 0;
  int filter = 0;                ///< Whose frame it is: they are counted.
  std::int64_t exposure_us = 0;  ///< Since 1970, by this computer.
  double exposure_s = 0;         ///< By the autopilot's clock.
  pilotage::MatchPrior prior;
  pilotage::MatchOptions options;
};

/// Times in µs are those of one clock that never goes back, since 1970.
class Flight {
 public:
  using Send = std::function<void(const mavlink::Bytes&)>;

  /// `map_sigma_m`: MapReader::largest_map_sigma_m().
  Flight(const FlightOptions& options, std::optional<double> map_sigma_m, Send send);

  /// What the autopilot said.
  void hear(const mavlink::Message& message, std::int64_t now_us);

  /// Whether a frame of this exposure may be given to begin(): the IMU's increments are there, or waiting is over.
  bool may_begin(std::int64_t exposure_us, std::int64_t now_us) const;
  /// What the matcher is to be asked about a frame; nothing where the flight has not begun, or the frame is of no use.
  /// At most four tasks may be unanswered.
  std::optional<MatchTask> begin(std::int64_t exposure_us, std::int64_t now_us);
  /// What the matcher answered.
  void end(const MatchTask& task, const pilotage::MatchResult& result, std::int64_t now_us);
  /// Nobody will answer: another frame went before it.
  void drop(const MatchTask& task);
  /// A picture that was not tried, and why.
  void skip(const std::string& why) { ++skipped_[why]; }
  void warn(const std::string& text, std::int64_t now_us) { say(mavlink::kWarning, text, now_us); }

  /// Flies on, and says what is due. Often: some hundred times a second.
  void go_on(std::int64_t now_us);

  /// A line of what became of the frames.
  std::string summary() const;

 private:
  struct Timed {
    double time_s = 0;  ///< By the autopilot's clock.
    mavlink::Message message;
  };
  /// Where the aircraft is believed to be at a time near that of the filter's state.
  struct Place {
    pilotage::GeodeticPoint position;
    double amsl_m = 0;
    double sigma_m = 0;
  };

  double autopilot_time_s(std::int64_t time_us) const;
  void set_clock(double stamp_s, std::int64_t now_us);
  void begin_anew();
  void hear_imu(const mavlink::Message& message, std::int64_t now_us);
  void hear_range(const mavlink::Message& message);
  bool is_of_own_place(const mavlink::Message& terrain) const;
  double gnss_disagreement_m() const;
  void hear_acknowledgement(const mavlink::Message& message, std::int64_t now_us);
  void ask_for_messages(std::int64_t now_us);
  bool may_align() const;
  void align(const mavlink::Message& imu);
  void go_on_behind_hole(const mavlink::Message& imu);
  void start(const pilotage::InsErrorModel& model, const pilotage::GeodeticPoint& place, double amsl_m,
             const Eigen::Vector3d& velocity_enu_mps, const pilotage::Attitude& attitude_deg);
  void advance(const mavlink::Message& imu);
  void advance_to(double time_s);
  bool advance_within(double time_s);
  void lose();
  std::optional<double> height_agl_m() const;
  double height_sigma_m();
  Place place_at(double time_s);
  void say(std::uint8_t severity, const std::string& text, std::int64_t now_us);
  void say_changes(std::int64_t now_us);
  void send_gps_input(std::int64_t now_us);
  bool gps_input_is_over(bool has_fix, std::int64_t now_us);
  void send_fix(const MatchTask& task, const pilotage::MatchResult& fix, std::int64_t now_us);

  FlightOptions options_;
  pilotage::NavigationOptions navigation_;
  Send send_;
  mavlink::Sender sender_;
  bool is_there_ = false;  ///< The autopilot was heard.
  std::map<std::uint32_t, std::int64_t> heard_us_;
  std::optional<double> clock_offset_us_;
  std::int64_t clock_set_us_ = 0;
  std::int64_t started_us_ = 0;  ///< This program, not the flight.

  int imu_id_ = -1;
  double stamp_s_ = 0;     ///< Of the last increment that was heard.
  std::deque<Timed> imu_;  ///< Heard, and not flown yet.
  std::deque<Timed> attitudes_, positions_;
  std::optional<Timed> gnss_, range_, terrain_;
  double pressure_offset_m_ = 0;  ///< Pressure altitude less that above mean sea level, at the start.
  double pressure_altitude_m_ = 0;

  std::optional<pilotage::NavigationFilter> filter_;
  int filters_ = 0;           ///< That were begun.
  int unanswered_ = 0;        ///< Frames of this one.
  bool is_lost_ = false;      ///< After a fix by sight the IMU was silent for too long: where it is, nobody knows.
  bool has_sighted_ = false;  ///< A fix was taken: from here on the autopilot's position does not count.
  double aligned_s_ = 0;
  double flown_s_ = 0;
  double flown_stamp_s_ = 0;           ///< Of the last increment that was flown as a whole.
  std::optional<double> hole_from_s_;  ///< Increments are missing from here on, and no attitude has come since.
  bool has_started_ = false;           ///< With start_sigma_m: once.
  std::int64_t gps_input_fix_us_ = 0;  ///< When it last had one; 0: never, since GNSS was there.
  bool gps_input_is_over_ = false;

  std::int64_t next_heartbeat_us_ = 0, next_gps_input_us_ = 0, next_request_us_ = 0, next_terrain_us_ = 0;
  std::map<std::string, std::int64_t> said_us_;
  bool said_begun_ = false, said_lost_ = false;
  int tried_ = 0, taken_ = 0, refused_ = 0, rejected_commands_ = 0;
  std::map<std::string, int> without_fix_, skipped_;
};
