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
  mavlink::Sender sender;
  int sensor_id = 1;               ///< GPS_INPUT.gps_id, GLOBAL_POSITION_SENSOR.id
  double rate_hz = 10;             ///< Of GPS_INPUT.
  double max_sigma_m = 100;        ///< GPS_INPUT has no fix beyond it.
  double imu_rate_hz = 100;        ///< What the autopilot is asked for.
  double hold_back_s = 0.1;        ///< Frames that come later than this after their exposure are of no use.
  double camera_latency_s = 0.05;  ///< From exposure to the picture's first byte, for pictures that do not say.
  pilotage::InsGrade ins_grade = pilotage::InsGrade::kConsumer;
  std::optional<double> ground_amsl_m;  ///< For aircraft without a rangefinder and a terrain model.
  std::optional<double> start_sigma_m;  ///< Start without GNSS: how far off the autopilot's position may be.
};

/// A frame on its way through the matcher.
struct MatchTask {
  pilotage::FrameNumber frame = 0;
  std::int64_t exposure_us = 0;  ///< Since 1970, by this computer.
  pilotage::MatchPrior prior;
  pilotage::MatchOptions options;
};

/// Times are µs since 1970 by this computer's clock, `now_us` of one call never before that of another.
class Flight {
 public:
  using Send = std::function<void(const mavlink::Bytes&)>;

  /// `map_sigma_m`: MapReader::largest_map_sigma_m().
  Flight(const FlightOptions& options, std::optional<double> map_sigma_m, Send send);

  /// What the autopilot said.
  void hear(const mavlink::Message& message, std::int64_t now_us);

  /// Whether a frame of this exposure may be given to begin(): its increments of the IMU are there, or cannot be waited
  /// for.
  bool may_begin(std::int64_t exposure_us, std::int64_t now_us) const;
  /// What the matcher is to be asked about a frame; nothing where the flight has not begun, or the frame is of no use.
  std::optional<MatchTask> begin(std::int64_t exposure_us);
  /// What the matcher answered.
  void end(const MatchTask& task, const pilotage::MatchResult& result, std::int64_t now_us);

  /// Flies on, and says what is due. Often: some hundred times a second.
  void go_on(std::int64_t now_us);

  void skip_frame() { ++skipped_; }
  /// A line of what became of the frames.
  std::string summary() const;

 private:
  struct Timed {
    double time_s = 0;  ///< By the autopilot's clock.
    mavlink::Message message;
  };
  struct Height {
    double time_s = -1e9;
    double agl_m = 0;
  };

  double autopilot_time_s(std::int64_t time_us) const;
  void set_clock(double stamp_s, std::int64_t now_us);
  void hear_imu(const mavlink::Message& message, std::int64_t now_us);
  void hear_acknowledgement(const mavlink::Message& message, std::int64_t now_us);
  void try_to_start(double time_s, double pressure_altitude_m);
  void advance_to(double time_s);
  void advance(const mavlink::Message& imu);
  std::optional<double> height_agl_m() const;
  double height_sigma_m();
  void say(std::uint8_t severity, const std::string& text, std::int64_t now_us);
  void send_gps_input(std::int64_t now_us);
  bool gps_input_is_over(bool has_fix, std::int64_t now_us);
  void send_fix(const MatchTask& task, const pilotage::MatchResult& fix, std::int64_t now_us);

  FlightOptions options_;
  pilotage::NavigationOptions navigation_;
  Send send_;
  mavlink::Sender sender_;
  std::uint8_t autopilot_ = 0;  ///< Its system id; 0 until it is heard.
  std::optional<double> clock_offset_us_;
  std::int64_t clock_set_us_ = 0;
  std::int64_t started_us_ = 0;  ///< This program, not the flight.

  std::deque<Timed> imu_;  ///< Heard, and not flown yet.
  std::optional<Timed> attitude_, position_, gnss_;
  Height range_, terrain_;
  double pressure_offset_m_ = 0;  ///< Pressure altitude less that above mean sea level, at the start.

  std::optional<pilotage::NavigationFilter> filter_;
  bool broken_ = false;  ///< The IMU was silent for too long: where the aircraft is, is not known any more.
  double flown_s_ = 0;
  std::int64_t gps_input_fix_us_ = 0;  ///< When it last had one; 0: never.
  bool gps_input_is_over_ = false;

  std::int64_t next_heartbeat_us_ = 0, next_gps_input_us_ = 0, next_request_us_ = 0;
  std::string said_;
  std::int64_t said_us_ = 0;
  int tried_ = 0, taken_ = 0, refused_ = 0, skipped_ = 0, late_ = 0, without_height_ = 0, rejected_commands_ = 0;
  std::map<std::string, int> without_fix_;
};
