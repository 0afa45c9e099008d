#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>
#include <utility>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/vehiclelog/log_builder.h"
#include "pilotage/vehiclelog/log_bytes.h"
#include "pilotage/vehiclelog/log_readers.h"
#include "pilotage/vehiclelog/mavlink_frame.h"

namespace pilotage {
namespace {

constexpr std::size_t kTelemetryStamp = 8;
constexpr double kEarliestStamp_s = 0;
constexpr double kLatestStamp_s = 1e11;

/// Big endian, unlike everything behind it.
double stamp_s(std::string_view bytes) {
  std::uint64_t microseconds = 0;
  for (std::size_t i = 0; i < kTelemetryStamp; ++i) {
    microseconds = microseconds << 8 | static_cast<unsigned char>(bytes[i]);
  }
  return static_cast<double>(microseconds) * 1e-6;
}

bool is_stamp(double time_s) {
  return time_s >= kEarliestStamp_s && time_s <= kLatestStamp_s;
}

/// Of a record that begins here; nothing when none does.
std::optional<MavlinkFrame> frame_behind_stamp(std::string_view bytes) {
  if (bytes.size() <= kTelemetryStamp || !is_stamp(stamp_s(bytes))) return std::nullopt;
  return read_mavlink_frame(bytes.substr(kTelemetryStamp));
}

double degrees_at(std::string_view payload, std::size_t offset) {
  return static_cast<double>(signed_at(payload, offset, 4)) * 1e-7;
}
double metres_of_mm_at(std::string_view payload, std::size_t offset) {
  return static_cast<double>(signed_at(payload, offset, 4)) * 1e-3;
}
double speed_of_cm_at(std::string_view payload, std::size_t offset) {
  return static_cast<double>(signed_at(payload, offset, 2)) * 1e-2;
}

void take_gps_raw(double time_s, std::string_view payload, LogBuilder& builder) {
  if (unsigned_at(payload, 28, 1) < 3) return;
  builder.add_position(&VehicleLog::gnss, time_s, degrees_at(payload, 8), degrees_at(payload, 12),
                       metres_of_mm_at(payload, 16));
  const auto speed_cmps = static_cast<double>(unsigned_at(payload, 24, 2));
  const auto course_cdeg = static_cast<double>(unsigned_at(payload, 26, 2));
  if (speed_cmps == 65535 || course_cdeg == 65535) return;
  const double course_rad = course_cdeg * 1e-2 * kRadPerDeg;
  builder.add_velocity(&VehicleLog::gnss, time_s, speed_cmps * 1e-2 * std::cos(course_rad),
                       speed_cmps * 1e-2 * std::sin(course_rad), 0);
}

void take_telemetry_attitude(double time_s, std::string_view payload, LogBuilder& builder) {
  builder.add_attitude(
      &VehicleLog::estimate, time_s,
      {float_at(payload, 12) / kRadPerDeg, float_at(payload, 8) / kRadPerDeg, float_at(payload, 4) / kRadPerDeg});
}

void take_global_position_int(double time_s, std::string_view payload, LogBuilder& builder) {
  builder.add_position(&VehicleLog::estimate, time_s, degrees_at(payload, 4), degrees_at(payload, 8),
                       metres_of_mm_at(payload, 12));
  builder.add_velocity(&VehicleLog::estimate, time_s, speed_of_cm_at(payload, 20), speed_of_cm_at(payload, 22),
                       speed_of_cm_at(payload, 24));
}

/// Ends with an extension of version 2: whole_payload() makes it 0, "unknown", where it is not sent.
void take_distance_sensor(double time_s, std::string_view payload, const std::string& source, LogBuilder& builder) {
  static constexpr std::uint64_t kDownward = 25;
  static constexpr std::uint64_t kNoSignal = 1;
  if (unsigned_at(payload, 12, 1) != kDownward) return;
  const std::uint64_t distance_cm = unsigned_at(payload, 8, 2);
  const std::uint64_t largest_cm = unsigned_at(payload, 6, 2);
  // At the largest range the sensor says "farther"; 0 says that it does not know its range.
  const bool in_range = distance_cm > unsigned_at(payload, 4, 2) && (largest_cm == 0 || distance_cm < largest_cm);
  if (!in_range || unsigned_at(payload, 38, 1) == kNoSignal) return builder.leave_out_range();
  builder.add_range(time_s, "range finder " + std::to_string(unsigned_at(payload, 11, 1)) + " of " + source,
                    static_cast<double>(distance_cm) * 1e-2);
}

void take_camera_trigger(double time_s, std::string_view payload, LogBuilder& builder) {
  LoggedCapture capture;
  capture.time_s = time_s;
  capture.number = static_cast<std::int64_t>(unsigned_at(payload, 8, 4));
  builder.add_capture(std::move(capture));
}

/// ArduPilot's feedback of a camera that was released.
void take_camera_feedback(double time_s, std::string_view payload, LogBuilder& builder) {
  LoggedCapture capture;
  capture.time_s = time_s;
  capture.number = static_cast<std::int64_t>(unsigned_at(payload, 40, 2));
  capture.point = GeodeticPoint{degrees_at(payload, 12), degrees_at(payload, 8)};
  capture.amsl_m = float_at(payload, 16);
  capture.attitude = Attitude{float_at(payload, 32), float_at(payload, 28), float_at(payload, 24)};
  builder.add_capture(std::move(capture));
}

void take_image_captured(double time_s, std::string_view payload, LogBuilder& builder) {
  if (signed_at(payload, 49, 1) == 0) return;  // the camera says that it failed
  LoggedCapture capture;
  capture.time_s = time_s;
  capture.number = signed_at(payload, 44, 4);
  capture.point = GeodeticPoint{degrees_at(payload, 16), degrees_at(payload, 12)};
  capture.amsl_m = metres_of_mm_at(payload, 20);
  builder.add_capture(std::move(capture));
}

constexpr std::uint32_t kHeartbeat = 0;
constexpr std::uint32_t kDistanceSensor = 132;
constexpr std::size_t kDistanceSensorSize = 39;

/// A message that tells where the aircraft is, or of a picture.
struct TelemetryMessage {
  std::uint32_t id;
  std::size_t size;  ///< Of the payload without extensions.
  void (*take)(double, std::string_view, LogBuilder&);
  bool is_capture = false;
};
constexpr TelemetryMessage kTelemetryMessages[] = {{24, 30, take_gps_raw},
                                                   {30, 28, take_telemetry_attitude},
                                                   {33, 28, take_global_position_int},
                                                   {112, 12, take_camera_trigger, true},
                                                   {180, 45, take_camera_feedback, true},
                                                   {263, 255, take_image_captured, true}};
/// What says most of a picture is taken, for one picture is often announced by several.
constexpr std::uint32_t kCaptureRanks[] = {180, 263, 112};

const TelemetryMessage* message_of(std::uint32_t id) {
  for (const TelemetryMessage& message : kTelemetryMessages) {
    if (message.id == id) return &message;
  }
  return nullptr;
}

/// Walks over the records of a log, from one sound place to the next.
class TelemetryRecords {
 public:
  TelemetryRecords(std::string_view bytes, LogLosses& losses) : bytes_(bytes), losses_(losses) {}

  bool next(double& time_s, MavlinkFrame& frame) {
    while (at_ < bytes_.size()) {
      const std::string_view rest = bytes_.substr(at_);
      const auto found = frame_behind_stamp(rest);
      if (!found || !found->checksum_holds) {
        if (found) ++losses_.bad_checksums;
        skip();
        continue;
      }
      time_s = stamp_s(rest);
      frame = *found;
      at_ += kTelemetryStamp + frame.size;
      return true;
    }
    return false;
  }

 private:
  /// To the next frame whose checksum holds. A message without a known seed must be followed by another frame: its
  /// first byte alone says too little.
  void skip() {
    std::size_t next = at_ + 1;
    while (next < bytes_.size() && !is_sound(next)) ++next;
    if (next >= bytes_.size()) losses_.truncated = true;
    losses_.bytes_skipped += static_cast<std::int64_t>(next - at_);
    at_ = next;
  }

  bool is_sound(std::size_t at) const {
    const auto frame = frame_behind_stamp(bytes_.substr(at));
    if (!frame || !frame->checksum_holds) return false;
    if (mavlink_crc_extra(frame->message_id)) return true;
    return frame_behind_stamp(bytes_.substr(at + kTelemetryStamp + frame->size)).has_value();
  }

  std::string_view bytes_;
  LogLosses& losses_;
  std::size_t at_ = 0;
};

/// Who sent a message.
struct TelemetrySource {
  std::uint8_t system = 0;
  std::uint8_t component = 0;

  bool operator==(const TelemetrySource&) const = default;
  bool operator<(const TelemetrySource& other) const {
    return std::pair(system, component) < std::pair(other.system, other.component);
  }
  std::string text() const {
    std::string text = "system " + std::to_string(system) + ", component " + std::to_string(component);
    if (component == 1) return text + " (autopilot)";
    if (component >= 100 && component <= 105) return text + " (camera)";
    if (component == 154 || (component >= 171 && component <= 175)) return text + " (gimbal)";
    if (component == 190) return text + " (ground station)";
    if (component >= 191 && component <= 194) return text + " (companion computer)";
    return text;
  }
};

TelemetrySource source_of(const MavlinkFrame& frame) {
  return {frame.system_id, frame.component_id};
}

/// What a source sent.
struct SourceContents {
  bool is_autopilot = false;  ///< Its heartbeat says that it flies the aircraft.
  std::int64_t poses = 0;     ///< Messages that tell where it is.
  std::map<std::uint32_t, std::int64_t> captures;
};

/// An autopilot by its heartbeat, of something that flies: not a ground station's, gimbal's or antenna tracker's.
bool is_heartbeat_of_autopilot(std::string_view payload) {
  static constexpr std::uint64_t kNoAutopilot = 8;
  static constexpr std::uint64_t kDoNotFly[] = {5,  6,  18,
                                                26, 27, 30};  // tracker, station, companion, gimbal, ADS-B, camera
  const std::uint64_t type = unsigned_at(payload, 4, 1);
  return unsigned_at(payload, 5, 1) != kNoAutopilot &&
         std::find(std::begin(kDoNotFly), std::end(kDoNotFly), type) == std::end(kDoNotFly);
}

/// Whose messages are taken.
struct TelemetryRoles {
  std::optional<TelemetrySource> autopilot;
  std::optional<TelemetrySource> camera;
  std::uint32_t capture_id = 0;

  bool takes(const TelemetryMessage& message, TelemetrySource source) const {
    if (message.is_capture) return message.id == capture_id && source == camera;
    return source == autopilot;
  }
};

/// Of the sources with poses: those with an autopilot's heartbeat before those with an autopilot's number before
/// others, and of each the one with most.
std::optional<TelemetrySource> autopilot_among(const std::map<TelemetrySource, SourceContents>& sources) {
  std::optional<TelemetrySource> best;
  std::tuple<bool, bool, std::int64_t> best_rank;
  for (const auto& [source, contents] : sources) {
    const std::tuple rank(contents.is_autopilot, source.component == 1, contents.poses);
    if (contents.poses == 0 || (best && rank <= best_rank)) continue;
    best = source;
    best_rank = rank;
  }
  return best;
}

TelemetryRoles roles_of_telemetry(std::string_view bytes) {
  std::map<TelemetrySource, SourceContents> sources;
  LogLosses losses;
  TelemetryRecords records(bytes, losses);
  double time_s = 0;
  MavlinkFrame frame;
  while (records.next(time_s, frame)) {
    const TelemetryMessage* message = message_of(frame.message_id);
    if (frame.message_id == kHeartbeat && is_heartbeat_of_autopilot(whole_payload(frame.payload, 9))) {
      sources[source_of(frame)].is_autopilot = true;
    }
    if (message == nullptr) continue;
    SourceContents& source = sources[source_of(frame)];
    ++(message->is_capture ? source.captures[message->id] : source.poses);
  }
  TelemetryRoles roles;
  roles.autopilot = autopilot_among(sources);
  // Pictures of this aircraft, by the message that says most, of the one source with most of them.
  for (const std::uint32_t id : kCaptureRanks) {
    std::int64_t most = 0;
    for (const auto& [source, contents] : sources) {
      const auto found = contents.captures.find(id);
      const bool of_aircraft = !roles.autopilot || source.system == roles.autopilot->system;
      if (!of_aircraft || found == contents.captures.end() || found->second <= most) continue;
      most = found->second;
      roles.camera = source;
      roles.capture_id = id;
    }
    if (roles.camera) break;
  }
  return roles;
}

}  // namespace

bool is_telemetry_log(std::string_view bytes) {
  const auto first = frame_behind_stamp(bytes);
  if (!first || !first->checksum_holds) return false;
  if (mavlink_crc_extra(first->message_id)) return true;
  const std::string_view behind = bytes.substr(kTelemetryStamp + first->size);
  return behind.empty() || frame_behind_stamp(behind).has_value();
}

VehicleLog parse_telemetry_log(const std::string& name, std::string_view bytes) {
  if (!is_telemetry_log(bytes)) {
    throw DataError(name + ": does not begin with a time and a whole frame of MAVLink, as telemetry logs do");
  }
  const TelemetryRoles roles = roles_of_telemetry(bytes);
  LogBuilder builder(LogFormat::kTelemetry);
  builder.set_utc(0);
  TelemetryRecords records(bytes, builder.losses());
  double time_s = 0;
  MavlinkFrame frame;
  while (records.next(time_s, frame)) {
    const TelemetrySource source = source_of(frame);
    if (frame.message_id == kDistanceSensor) {
      const bool of_aircraft = !roles.autopilot || source.system == roles.autopilot->system;
      if (!of_aircraft) {
        builder.leave_out_source(source.text());
      } else if (builder.accept(time_s)) {
        take_distance_sensor(time_s, whole_payload(frame.payload, kDistanceSensorSize), source.text(), builder);
      }
      continue;
    }
    const TelemetryMessage* message = message_of(frame.message_id);
    if (message == nullptr) continue;
    if (!roles.takes(*message, source)) {
      // Another announcement of the same pictures is no source of its own.
      if (!message->is_capture || message->id == roles.capture_id) builder.leave_out_source(source.text());
      continue;
    }
    if (builder.accept(time_s)) message->take(time_s, whole_payload(frame.payload, message->size), builder);
  }
  return builder.finish();
}

}  // namespace pilotage
