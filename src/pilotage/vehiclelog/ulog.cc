#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/vehiclelog/log_builder.h"
#include "pilotage/vehiclelog/log_bytes.h"
#include "pilotage/vehiclelog/log_readers.h"
#include "pilotage/vehiclelog/ulog_format.h"

namespace pilotage {
namespace {

constexpr std::string_view kUlogMagic("ULog\x01\x12\x35", 7);
constexpr std::size_t kUlogHeader = 16;
constexpr std::size_t kMessageHead = 3;
/// The whole of a synchronisation message: how to find the next sound place.
constexpr std::string_view kUlogSync("\x08\x00S\x2F\x73\x13\x20\x25\x0C\xBB\x12", 11);
constexpr std::string_view kMessageTypes = "BFIMPQARDLCSO";

struct UlogMessage {
  char type = 0;
  std::string_view body;
};

/// Walks over the messages of a file, from one sound place to the next.
class UlogMessages {
 public:
  UlogMessages(std::string_view bytes, LogLosses& losses) : bytes_(bytes), losses_(losses), at_(kUlogHeader) {}

  bool next(UlogMessage& message) {
    while (at_ < end()) {
      if (read(message)) {
        if (message.type == 'B') take_flags(message.body);
        return true;
      }
      skip();
    }
    if (appended_.empty()) return false;
    // The part that was appended later; the last message before it may have been cut.
    at_ = appended_.front();
    appended_.erase(appended_.begin());
    return next(message);
  }

  bool unknown_flags() const { return unknown_flags_; }

 private:
  std::size_t end() const { return appended_.empty() ? bytes_.size() : appended_.front(); }

  bool read(UlogMessage& message) {
    if (end() - at_ < kMessageHead) return false;
    const std::size_t size = unsigned_at(bytes_, at_, 2);
    message.type = bytes_[at_ + 2];
    if (kMessageTypes.find(message.type) == std::string_view::npos) return false;
    if (size > end() - at_ - kMessageHead) {
      cut_ = true;
      return false;
    }
    message.body = bytes_.substr(at_ + kMessageHead, size);
    at_ += kMessageHead + size;
    cut_ = false;
    return true;
  }

  void skip() {
    const std::size_t sync = bytes_.substr(0, end()).find(kUlogSync, at_ + 1);
    const std::size_t next = sync == std::string_view::npos ? end() : sync;
    if (next == bytes_.size() && (cut_ || next - at_ < kMessageHead)) losses_.truncated = true;
    losses_.bytes_skipped += static_cast<std::int64_t>(next - at_);
    cut_ = false;
    at_ = next;
  }

  void take_flags(std::string_view flags) {
    if (flags.size() < 40 || seen_flags_) return;
    seen_flags_ = true;
    unknown_flags_ = (flags[8] & ~1) != 0 || flags.substr(9, 7).find_first_not_of('\0') != std::string_view::npos;
    if ((flags[8] & 1) == 0) return;
    for (std::size_t i = 16; i < 40; i += 8) {
      const std::uint64_t offset = unsigned_at(flags, i, 8);
      if (offset > at_ && offset < bytes_.size()) appended_.push_back(static_cast<std::size_t>(offset));
    }
    std::sort(appended_.begin(), appended_.end());
  }

  std::string_view bytes_;
  LogLosses& losses_;
  std::size_t at_;
  std::vector<std::size_t> appended_;
  bool seen_flags_ = false;
  bool unknown_flags_ = false;
  bool cut_ = false;
};

/// What is known of the stream with a number: its topic, of which instance.
struct UlogStream {
  std::string topic;
  int instance = 0;
  std::int64_t records = 0;
  bool used = false;
};

struct UlogContents {
  UlogFormats formats;
  std::map<unsigned, UlogStream> streams;
};

/// One record of a topic.
class UlogRecord {
 public:
  UlogRecord(const UlogFormats& formats, const std::string& topic, std::string_view bytes,
             std::map<std::string, std::optional<UlogNumbers>, std::less<>>& places)
      : formats_(formats), topic_(topic), bytes_(bytes), places_(places) {}

  /// NaN when the topic has no such field or the record is too short.
  double number(std::string_view field, std::size_t index = 0) const {
    auto place = places_.find(field);
    if (place == places_.end()) {
      place = places_.emplace(std::string(field), formats_.find(topic_, field)).first;
    }
    return place->second ? ulog_number(*place->second, bytes_, index).value_or(kNaN) : kNaN;
  }
  bool has(std::string_view field) const { return number(field) == number(field); }
  /// A flag that older logs do not have counts as set.
  bool not_false(std::string_view field) const { return number(field) != 0; }
  double time_s() const { return number("timestamp") * 1e-6; }

 private:
  const UlogFormats& formats_;
  const std::string& topic_;
  std::string_view bytes_;
  std::map<std::string, std::optional<UlogNumbers>, std::less<>>& places_;
};

using TopicTrack = LoggedTrack VehicleLog::*;

void take_global_position(const UlogRecord& record, TopicTrack track, LogBuilder& builder) {
  builder.add_position(track, record.time_s(), record.number("lat"), record.number("lon"), record.number("alt"));
  if (track == &VehicleLog::estimate && record.has("terrain_alt_valid") && record.not_false("terrain_alt_valid")) {
    builder.add_height(record.time_s(), record.number("alt") - record.number("terrain_alt"));
  }
}

/// The point is taken only where no topic says it by itself.
void take_local_position(const UlogRecord& record, TopicTrack track, bool takes_point, LogBuilder& builder) {
  const double time_s = record.time_s();
  if (record.not_false("v_xy_valid")) {
    builder.add_velocity(track, time_s, record.number("vx"), record.number("vy"), record.number("vz"));
  }
  if (track == &VehicleLog::estimate && record.has("dist_bottom_valid") && record.not_false("dist_bottom_valid")) {
    builder.add_height(time_s, record.number("dist_bottom"));
  }
  const double north_m = record.number("x");
  const double east_m = record.number("y");
  const double lat_deg = record.number("ref_lat");
  const double lon_deg = record.number("ref_lon");
  if (!takes_point || !record.not_false("xy_valid") || !record.not_false("xy_global")) return;
  const bool near = std::max(std::abs(north_m), std::abs(east_m)) < 1e6 && is_logged_point(lat_deg, lon_deg);
  if (!near || !(north_m + east_m == north_m + east_m)) {
    ++builder.losses().bad_values;
    return;
  }
  const GeodeticPoint point = LocalFrame({lon_deg, lat_deg}).geodetic_from_enu({east_m, north_m, 0});
  builder.add_position(track, time_s, point.lat_deg, point.lon_deg, record.number("ref_alt") - record.number("z"));
}

void take_attitude(const UlogRecord& record, TopicTrack track, LogBuilder& builder) {
  const auto attitude = attitude_of_quaternion(record.number("q", 0), record.number("q", 1), record.number("q", 2),
                                               record.number("q", 3));
  if (attitude) return builder.add_attitude(track, record.time_s(), *attitude);
  ++builder.losses().bad_values;
}

void take_gnss(const UlogRecord& record, LogBuilder& builder) {
  if (record.number("fix_type") < 3) return;
  const bool in_degrees = record.has("latitude_deg");
  const double time_s = record.time_s();
  const double lat_deg = in_degrees ? record.number("latitude_deg") : record.number("lat") * 1e-7;
  const double lon_deg = in_degrees ? record.number("longitude_deg") : record.number("lon") * 1e-7;
  builder.add_position(&VehicleLog::gnss, time_s, lat_deg, lon_deg,
                       in_degrees ? record.number("altitude_msl_m") : record.number("alt") * 1e-3);
  if (record.not_false("vel_ned_valid")) {
    builder.add_velocity(&VehicleLog::gnss, time_s, record.number("vel_n_m_s"), record.number("vel_e_m_s"),
                         record.number("vel_d_m_s"));
  }
  if (record.number("time_utc_usec") > 0) builder.set_utc(record.number("time_utc_usec") * 1e-6 - time_s);
}

void take_distance(const UlogRecord& record, int instance, LogBuilder& builder) {
  static constexpr double kDownward = 25;  // ROTATION_DOWNWARD_FACING
  static constexpr double kNoSignal = 0;   // −1: unknown
  if (record.number("orientation") != kDownward) return;
  const double distance_m = record.number("current_distance");
  // At the largest range the sensor says "farther".
  const bool in_range = distance_m > record.number("min_distance") && distance_m < record.number("max_distance");
  if (!in_range || record.number("signal_quality") == kNoSignal) return builder.leave_out_range();
  builder.add_range(record.time_s(), "distance_sensor " + std::to_string(instance), distance_m);
}

void take_capture(const UlogRecord& record, LogBuilder& builder) {
  if (record.has("result") && !record.not_false("result")) return;
  LoggedCapture capture;
  capture.time_s = record.time_s();
  capture.number = capture_number(record.number("seq"));
  if (record.has("lat")) capture.point = GeodeticPoint{record.number("lon"), record.number("lat")};
  capture.amsl_m = record.number("alt");
  capture.agl_m = record.number("ground_distance");
  builder.add_capture(std::move(capture));
}

/// Which topics say what, in this log: the first of each line that has records, of its lowest instance.
struct UlogRoles {
  std::string position, gnss, truth_position, capture;
};

std::string first_with_records(const UlogContents& contents, std::initializer_list<std::string_view> topics) {
  for (const std::string_view topic : topics) {
    for (const auto& [id, stream] : contents.streams) {
      if (stream.topic == topic && stream.records > 0) return std::string(topic);
    }
  }
  return "";
}

UlogRoles roles_of(const UlogContents& contents) {
  return {first_with_records(contents, {"vehicle_global_position", "vehicle_local_position"}),
          first_with_records(contents, {"vehicle_gps_position", "sensor_gps"}),
          first_with_records(contents, {"vehicle_global_position_groundtruth", "vehicle_local_position_groundtruth"}),
          first_with_records(contents, {"camera_capture", "camera_trigger"})};
}

void take_record(const std::string& topic, const UlogRecord& record, const UlogRoles& roles, LogBuilder& builder) {
  const TopicTrack track = topic.ends_with("_groundtruth") ? &VehicleLog::truth : &VehicleLog::estimate;
  const std::string& position = track == &VehicleLog::truth ? roles.truth_position : roles.position;
  if (topic.starts_with("vehicle_global_position")) return take_global_position(record, track, builder);
  if (topic.starts_with("vehicle_local_position"))
    return take_local_position(record, track, topic == position, builder);
  if (topic.starts_with("vehicle_attitude")) return take_attitude(record, track, builder);
  if (topic == roles.gnss) return take_gnss(record, builder);
  if (topic == roles.capture) return take_capture(record, builder);
}

bool is_used(const std::string& topic, const UlogRoles& roles) {
  static const std::set<std::string> always{"vehicle_global_position", "vehicle_global_position_groundtruth",
                                            "vehicle_local_position",  "vehicle_local_position_groundtruth",
                                            "vehicle_attitude",        "vehicle_attitude_groundtruth",
                                            "distance_sensor"};
  return always.contains(topic) || (!topic.empty() && (topic == roles.gnss || topic == roles.capture));
}

/// Formats and streams, with how many records each has: what a topic is worth shows only at the end.
UlogContents read_contents(const std::string& name, std::string_view bytes) {
  UlogContents contents;
  LogLosses losses;
  UlogMessages messages(bytes, losses);
  UlogMessage message;
  while (messages.next(message)) {
    const std::string_view body = message.body;
    if (message.type == 'F') contents.formats.add(body);
    if (message.type == 'A' && body.size() > 3) {
      const auto id = static_cast<unsigned>(unsigned_at(body, 1, 2));
      contents.streams.try_emplace(id, UlogStream{std::string(body.substr(3)), static_cast<unsigned char>(body[0]), 0});
    }
    if (message.type != 'D' || body.size() < 2) continue;
    const auto stream = contents.streams.find(static_cast<unsigned>(unsigned_at(body, 0, 2)));
    if (stream != contents.streams.end()) ++stream->second.records;
  }
  if (messages.unknown_flags()) {
    throw DataError(name + ": this ULog file needs a feature that is not known (incompatible flags other than 1)");
  }
  // Of several instances of a topic the lowest that has records.
  std::map<std::string, UlogStream*> lowest;
  for (auto& [id, stream] : contents.streams) {
    if (stream.records == 0) continue;
    UlogStream*& best = lowest[stream.topic];
    if (best == nullptr || stream.instance < best->instance) best = &stream;
  }
  for (auto& [topic, stream] : lowest) stream->used = true;
  return contents;
}

void take_dropout(std::string_view body, LogLosses& losses) {
  ++losses.dropouts;
  if (body.size() >= 2) losses.dropout_s += static_cast<double>(unsigned_at(body, 0, 2)) * 1e-3;
}

}  // namespace

bool is_ulog(std::string_view bytes) {
  return bytes.starts_with(kUlogMagic);
}

VehicleLog parse_ulog(const std::string& name, std::string_view bytes) {
  if (!is_ulog(bytes) || bytes.size() < kUlogHeader) {
    throw DataError(name + ": the head of the ULog file is cut short: " + std::to_string(bytes.size()) +
                    " bytes, at least 16 are needed");
  }
  const UlogContents contents = read_contents(name, bytes);
  const UlogRoles roles = roles_of(contents);
  LogBuilder builder(LogFormat::kUlog);
  std::map<std::string, std::map<std::string, std::optional<UlogNumbers>, std::less<>>> places;
  UlogMessages messages(bytes, builder.losses());
  UlogMessage message;
  while (messages.next(message)) {
    if (message.type == 'O') take_dropout(message.body, builder.losses());
    if (message.type != 'D' || message.body.size() < 2) continue;
    const auto stream = contents.streams.find(static_cast<unsigned>(unsigned_at(message.body, 0, 2)));
    if (stream == contents.streams.end() || !is_used(stream->second.topic, roles)) continue;
    const std::string& topic = stream->second.topic;
    const bool is_distance = topic == "distance_sensor";  // of which the builder chooses one
    if (!stream->second.used && !is_distance) {
      builder.leave_out_source(topic + " " + std::to_string(stream->second.instance));
      continue;
    }
    const UlogRecord record(contents.formats, topic, message.body.substr(2), places[topic]);
    if (!builder.accept(record.time_s())) continue;
    if (is_distance) {
      take_distance(record, stream->second.instance, builder);
    } else {
      take_record(topic, record, roles, builder);
    }
  }
  return builder.finish();
}

}  // namespace pilotage
