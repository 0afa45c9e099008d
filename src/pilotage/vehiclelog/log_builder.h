#pragma once

#include <map>
#include <optional>
#include <string>

#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {

/// Records may be out of order by so much: several tasks of an autopilot write into one log.
inline constexpr double kLogClockSlack_s = 1;
/// A longer silence is believed only when the records behind it agree.
inline constexpr double kLongestLogGap_s = 60;
/// So many records in a row that agree with each other and not with those before set the clock.
inline constexpr int kRecordsThatSetClock = 8;

/// The log's own count of a picture, from a field that may hold anything: 0 for what is no whole number of 0 … 2^53.
std::int64_t capture_number(double stated);

/// Collects what a reader finds, and judges its times and numbers. A time that contradicts the ones before is left out
/// as damaged until kRecordsThatSetClock in a row agree with each other: later ones by more than the longest gap are
/// then taken for a gap, earlier ones for a clock that was set back. There the log falls into two parts, of which the
/// one with more records is kept, because a time of one means nothing in the other.
class LogBuilder {
 public:
  explicit LogBuilder(LogFormat format);

  /// Whether a record of this time is to be used.
  bool accept(double time_s);

  // Each adds what is sound, and counts what is not.
  void add_position(LoggedTrack VehicleLog::*track, double time_s, double lat_deg, double lon_deg, double amsl_m);
  void add_velocity(LoggedTrack VehicleLog::*track, double time_s, double north_mps, double east_mps, double down_mps);
  void add_attitude(LoggedTrack VehicleLog::*track, double time_s, const Attitude& attitude);
  void add_height(double time_s, double agl_m);
  /// A sound reading of the range finder `sensor` along the body's down axis; of several sensors, the one with most
  /// readings counts (of equal ones the first by name), the others are counted as other sources.
  void add_range(double time_s, const std::string& sensor, double range_m);
  /// A reading that says no distance.
  void leave_out_range() { ++losses_.ranges_left_out; }
  /// Beyond 50 names they are counted together.
  void leave_out_source(const std::string& source);
  /// Without its point, attitude or heights where these are not sound.
  void add_capture(LoggedCapture capture);
  void set_utc(double utc_minus_log_s);

  LogLosses& losses() { return losses_; }

  /// The larger part, in the order of times.
  VehicleLog finish();

 private:
  struct Part {
    VehicleLog log;
    std::map<std::string, std::vector<LoggedHeight>> ranges;  ///< Along the body's down axis, by sensor.
    std::int64_t records = 0;
  };

  bool agrees(double time_s, double last_s) const;
  void begin_part();
  /// Chooses the sensor, and turns what it says upright.
  void take_ranges(Part& part);

  LogFormat format_;
  Part part_;
  Part largest_;
  std::optional<double> last_s_;
  double doubtful_s_ = 0;
  int doubtful_ = 0;
  LogLosses losses_;
};

/// The attitude of the quaternion that turns body (nose, right, down) into north, east, down; nothing unless its length
/// is 1 within 10 %.
std::optional<Attitude> attitude_of_quaternion(double w, double x, double y, double z);

/// Finite, on Earth, and not 0°, 0°, which stands for "not known".
bool is_logged_point(double lat_deg, double lon_deg);

}  // namespace pilotage
