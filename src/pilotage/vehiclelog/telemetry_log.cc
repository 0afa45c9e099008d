#include <cmath>
#include <set>
#include <string>

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

void take_distance_sensor(double time_s, std::string_view payload, LogBuilder& builder) {
  static constexpr std::uint64_t kDownward = 25;
  const std::uint64_t distance_cm = unsigned_at(payload, 8, 2);
  const bool in_range = distance_cm >= unsigned_at(payload, 4, 2) && distance_cm <= unsigned_at(payload, 6, 2);
  if (unsigned_at(payload, 12, 1) != kDownward || !in_range) return;
  builder.add_height(time_s, static_cast<double>(distance_cm) * 1e-2);
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
                                                   {132, 14, take_distance_sensor},
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

struct TelemetryContents {
  std::optional<std::uint8_t> system;  ///< The first that says where it is.
  std::uint32_t capture_id = 0;
};

TelemetryContents contents_of(std::string_view bytes) {
  TelemetryContents contents;
  std::set<std::uint32_t> captures;
  LogLosses losses;
  TelemetryRecords records(bytes, losses);
  double time_s = 0;
  MavlinkFrame frame;
  while (records.next(time_s, frame)) {
    const TelemetryMessage* message = message_of(frame.message_id);
    if (message == nullptr) continue;
    if (message->is_capture) captures.insert(message->id);
    if (!message->is_capture && !contents.system) contents.system = frame.system_id;
  }
  for (const std::uint32_t id : kCaptureRanks) {
    if (contents.capture_id == 0 && captures.contains(id)) contents.capture_id = id;
  }
  return contents;
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
  const TelemetryContents contents = contents_of(bytes);
  LogBuilder builder(LogFormat::kTelemetry);
  builder.set_utc(0);
  TelemetryRecords records(bytes, builder.losses());
  double time_s = 0;
  MavlinkFrame frame;
  while (records.next(time_s, frame)) {
    const TelemetryMessage* message = message_of(frame.message_id);
    if (message == nullptr || (message->is_capture && message->id != contents.capture_id)) continue;
    if (frame.system_id != contents.system.value_or(frame.system_id)) {
      ++builder.losses().other_sources;
      continue;
    }
    if (!builder.accept(time_s)) continue;
    message->take(time_s, whole_payload(frame.payload, message->size), builder);
  }
  return builder.finish();
}

}  // namespace pilotage
