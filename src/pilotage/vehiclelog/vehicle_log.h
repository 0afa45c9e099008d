#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/base/options.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

enum class LogFormat { kUlog, kDataFlash, kTelemetry, kAirSim };
inline EnumNames<LogFormat> enum_names(LogFormat) {
  return {{LogFormat::kUlog, "ulog"},
          {LogFormat::kDataFlash, "dataflash"},
          {LogFormat::kTelemetry, "telemetry"},
          {LogFormat::kAirSim, "airsim"}};
}

struct LoggedPosition {
  double time_s = 0;
  GeodeticPoint point;
  double amsl_m = std::numeric_limits<double>::quiet_NaN();  ///< Above mean sea level; NaN: not said.
};

/// North, east, down.
struct LoggedVelocity {
  double time_s = 0;
  double north_mps = 0;
  double east_mps = 0;
  double down_mps = 0;
};

struct LoggedAttitude {
  double time_s = 0;
  Attitude attitude;
};

/// Where one source says that the aircraft was. Each list in the order of its times.
struct LoggedTrack {
  std::vector<LoggedPosition> positions;
  std::vector<LoggedVelocity> velocities;
  std::vector<LoggedAttitude> attitudes;
};

/// Above the ground straight below.
struct LoggedHeight {
  double time_s = 0;
  double agl_m = 0;
};

/// The camera was released, or has taken a picture.
struct LoggedCapture {
  double time_s = 0;
  std::int64_t number = 0;             ///< The log's own count.
  std::optional<GeodeticPoint> point;  ///< Where the log says that it was.
  double amsl_m = std::numeric_limits<double>::quiet_NaN();
  double agl_m = std::numeric_limits<double>::quiet_NaN();
  std::optional<Attitude> attitude;  ///< Of the aircraft.
  std::string file;                  ///< The picture, relative to the log's folder; "" when the log does not say it.
};

/// What could not be used of a log.
struct LogLosses {
  std::int64_t bytes_skipped = 0;  ///< No record could be read there.
  std::int64_t bad_checksums = 0;  ///< Records whose checksum is wrong.
  std::int64_t bad_values = 0;  ///< Records with a number that cannot be (latitude 95°, a quaternion of length 0 …).
  /// Records of a second sensor, component or aircraft, beside the one that was taken: how many of which.
  std::map<std::string, std::int64_t> other_sources;
  std::int64_t ranges_left_out = 0;   ///< Readings of a range finder that say no distance: no signal, out of range.
  std::int64_t bad_times = 0;         ///< Records whose time contradicts those around it.
  std::int64_t clock_jumps = 0;       ///< The clock went back for good, and a part of the log began anew …
  std::int64_t records_left_out = 0;  ///< … whose records, or those before it, were left out: the larger part counts.
  std::int64_t gaps = 0;              ///< Longer than kLongestLogGap_s without a record.
  std::int64_t dropouts = 0;          ///< The logger itself says that it lost something;
  double dropout_s = 0;               ///< for so long.
  bool truncated = false;             ///< The last record is cut short.
};

/// A flight as an autopilot or a simulator logged it: seconds by the log's own clock.
struct VehicleLog {
  LogFormat format = LogFormat::kUlog;
  LoggedTrack estimate;               ///< What the autopilot believed.
  LoggedTrack gnss;                   ///< What its receiver said: positions and velocities.
  LoggedTrack truth;                  ///< Of a simulator that knows it; empty for real flights.
  std::vector<LoggedHeight> ranges;   ///< By one range finder that looks down, turned upright by the attitude.
  std::vector<LoggedHeight> heights;  ///< By a terrain database or the autopilot's own estimate.
  std::vector<LoggedCapture> captures;
  std::optional<double> utc_minus_log_s;  ///< Where the log says both times at once.
  LogLosses losses;
};

/// What the first bytes say it is; nothing when it is none of these. AirSim's is the text of airsim_rec.txt.
std::optional<LogFormat> log_format_of(std::string_view bytes);

/// Where AirSim's own frame begins (OriginGeopoint of its settings.json): its recordings do not say it.
struct LogOrigin {
  GeodeticPoint point;
  double amsl_m = 0;
};

/// The log in `bytes`, by the reader of its format; `name` stands for it in messages. What is damaged or cut short is
/// left out and counted in VehicleLog::losses. Throws DataError when the bytes are no log of a known format, when its
/// head is damaged, and when not one position, attitude or capture can be read; UsageError for an AirSim recording
/// without `origin`.
VehicleLog parse_vehicle_log(const std::string& name, std::string_view bytes, const std::optional<LogOrigin>& origin);

/// The same of a file of at most 1 GiB.
VehicleLog read_vehicle_log(const std::filesystem::path& path, const std::optional<LogOrigin>& origin = {});

/// What was lost and what is not in the log, each as a sentence; empty for a whole one.
std::vector<std::string> notes_of_log(const VehicleLog& log);

/// From the first record to the last.
double duration_s(const VehicleLog& log);

}  // namespace pilotage
