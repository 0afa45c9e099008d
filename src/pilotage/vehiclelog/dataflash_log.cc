#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/vehiclelog/log_builder.h"
#include "pilotage/vehiclelog/log_bytes.h"
#include "pilotage/vehiclelog/log_readers.h"

namespace pilotage {
namespace {

constexpr std::string_view kRecordMagic("\xA3\x95", 2);
constexpr std::uint8_t kFormatId = 128;
constexpr std::size_t kFormatSize = 89;
constexpr std::size_t kRecordHead = 3;

/// What a character of a format stands for: bytes, and what its number is multiplied by.
struct FieldKind {
  char letter;
  std::size_t size;
  enum { kSigned, kUnsigned, kFloat, kDouble, kHalf, kText } kind;
  double scale = 1;
};
constexpr FieldKind kFieldKinds[] = {
    {'a', 64, FieldKind::kText},        {'b', 1, FieldKind::kSigned},         {'B', 1, FieldKind::kUnsigned},
    {'h', 2, FieldKind::kSigned},       {'H', 2, FieldKind::kUnsigned},       {'i', 4, FieldKind::kSigned},
    {'I', 4, FieldKind::kUnsigned},     {'f', 4, FieldKind::kFloat},          {'d', 8, FieldKind::kDouble},
    {'g', 2, FieldKind::kHalf},         {'n', 4, FieldKind::kText},           {'N', 16, FieldKind::kText},
    {'Z', 64, FieldKind::kText},        {'c', 2, FieldKind::kSigned, 0.01},   {'C', 2, FieldKind::kUnsigned, 0.01},
    {'e', 4, FieldKind::kSigned, 0.01}, {'E', 4, FieldKind::kUnsigned, 0.01}, {'L', 4, FieldKind::kSigned, 1e-7},
    {'M', 1, FieldKind::kUnsigned},     {'q', 8, FieldKind::kSigned},         {'Q', 8, FieldKind::kUnsigned}};

const FieldKind* kind_of(char letter) {
  for (const FieldKind& kind : kFieldKinds) {
    if (kind.letter == letter) return &kind;
  }
  return nullptr;
}

/// IEEE 754 binary16.
double half_at(std::string_view bytes, std::size_t offset) {
  const auto bits = static_cast<unsigned>(unsigned_at(bytes, offset, 2));
  const int exponent = static_cast<int>((bits >> 10) & 31);
  const double fraction = bits & 1023;
  const double sign = (bits & 0x8000) != 0 ? -1 : 1;
  if (exponent == 31) return kNaN;
  return sign * (exponent == 0 ? std::ldexp(fraction, -24) : std::ldexp(fraction + 1024, exponent - 25));
}

double number_at(const FieldKind& kind, std::string_view bytes, std::size_t offset) {
  switch (kind.kind) {
    case FieldKind::kSigned:
      return static_cast<double>(signed_at(bytes, offset, kind.size)) * kind.scale;
    case FieldKind::kUnsigned:
      return static_cast<double>(unsigned_at(bytes, offset, kind.size)) * kind.scale;
    case FieldKind::kFloat:
      return float_at(bytes, offset);
    case FieldKind::kDouble:
      return double_at(bytes, offset);
    case FieldKind::kHalf:
      return half_at(bytes, offset);
    case FieldKind::kText:
      break;
  }
  return kNaN;
}

struct FieldPlace {
  const FieldKind* kind = nullptr;
  std::size_t offset = 0;
};

struct RecordFormat {
  std::string name;
  std::size_t size = 0;
  std::map<std::string, FieldPlace, std::less<>> fields;
};

/// A format record; nothing when its fields do not fill its size, as those of a damaged one.
std::optional<RecordFormat> format_of(std::string_view record) {
  RecordFormat format;
  format.size = static_cast<unsigned char>(record[4]);
  format.name = text_until_zero(record.substr(5, 4));
  const std::string letters = text_until_zero(record.substr(9, 16));
  std::string labels = text_until_zero(record.substr(25, 64));
  std::size_t offset = kRecordHead;
  std::size_t at = 0;
  for (const char letter : letters) {
    const FieldKind* kind = kind_of(letter);
    if (kind == nullptr) return std::nullopt;
    const std::size_t end = std::min(labels.find(',', at), labels.size());
    if (at < labels.size()) format.fields[labels.substr(at, end - at)] = {kind, offset};
    at = std::min(end + 1, labels.size());
    offset += kind->size;
  }
  if (offset != format.size) return std::nullopt;
  return format;
}

class DataFlashRecord {
 public:
  DataFlashRecord(const RecordFormat& format, std::string_view bytes) : format_(format), bytes_(bytes) {}

  const std::string& name() const { return format_.name; }
  /// Of the first of these fields that there is; NaN when there is none.
  double number(std::initializer_list<std::string_view> names) const {
    for (const std::string_view field : names) {
      const auto place = format_.fields.find(field);
      if (place != format_.fields.end()) return number_at(*place->second.kind, bytes_, place->second.offset);
    }
    return kNaN;
  }
  double number(std::string_view field) const { return number({field}); }
  bool has(std::string_view field) const { return format_.fields.find(field) != format_.fields.end(); }
  double time_s() const { return number("TimeUS") * 1e-6; }
  /// Which of several receivers, filters or sensors.
  int instance() const {
    for (const std::string_view field : {"I", "C", "Instance"}) {
      const double value = has(field) ? number(field) : 0;
      if (value != 0) return value > 0 && value <= 255 ? static_cast<int>(value) : 255;
    }
    return 0;
  }

 private:
  const RecordFormat& format_;
  std::string_view bytes_;
};

Attitude attitude_of(const DataFlashRecord& record) {
  return {record.number({"Yaw", "Y"}), record.number({"Pitch", "P"}), record.number({"Roll", "R"})};
}

void take_dataflash_gnss(const DataFlashRecord& record, LogBuilder& builder) {
  static constexpr double kWeek_s = 604800;
  static constexpr double kGpsEpoch_s = 315964800;
  static constexpr double kLeapSeconds = 18;  // since 2017
  if (!(record.number("Status") >= 3)) return;
  const double time_s = record.time_s();
  builder.add_position(&VehicleLog::gnss, time_s, record.number("Lat"), record.number({"Lng", "Lon"}),
                       record.number("Alt"));
  const double speed_mps = record.number("Spd");
  const double course_rad = record.number("GCrs") * kRadPerDeg;
  if (record.has("Spd") && record.has("GCrs")) {
    builder.add_velocity(&VehicleLog::gnss, time_s, speed_mps * std::cos(course_rad), speed_mps * std::sin(course_rad),
                         record.has("VZ") ? record.number("VZ") : 0);
  }
  const double week = record.number("GWk");
  if (week > 0) {
    builder.set_utc(kGpsEpoch_s + week * kWeek_s + record.number("GMS") * 1e-3 - kLeapSeconds - time_s);
  }
}

void take_dataflash_capture(const DataFlashRecord& record, LogBuilder& builder) {
  LoggedCapture capture;
  capture.time_s = record.time_s();
  capture.number = capture_number(record.number("Img"));
  if (record.has("Lat")) capture.point = GeodeticPoint{record.number({"Lng", "Lon"}), record.number("Lat")};
  capture.amsl_m = record.number("Alt");
  capture.attitude = attitude_of(record);
  builder.add_capture(std::move(capture));
}

/// A record of one sensor, or of two as older ones are. Without a status, 0 m says that there is no reading.
void take_range_finder(const DataFlashRecord& record, LogBuilder& builder) {
  static constexpr double kDownward = 25;
  static constexpr double kGood = 4;
  static constexpr double kNoSignal = 0;  // −1: unknown
  for (const std::string_view suffix : {"", "1", "2"}) {
    const auto field = [&](std::string_view name) { return record.number(std::string(name) + std::string(suffix)); };
    const double distance_m = field("Dist");
    const double orientation = field("Orient");
    const double status = field("Stat");
    if (std::isnan(distance_m) || (!std::isnan(orientation) && orientation != kDownward)) continue;
    if ((!std::isnan(status) && status != kGood) || field("Quality") == kNoSignal || !(distance_m > 0)) {
      builder.leave_out_range();
      continue;
    }
    const std::string sensor = suffix.empty() ? std::to_string(record.instance()) : std::string(suffix);
    builder.add_range(record.time_s(), "range finder " + sensor, distance_m);
  }
}

void take_terrain(const DataFlashRecord& record, LogBuilder& builder) {
  static constexpr double kTerrainKnown = 2;
  if (record.number("Status") == kTerrainKnown) builder.add_height(record.time_s(), record.number("CHeight"));
}

bool is_filter(const std::string& name) {
  return name == "XKF1" || name == "NKF1";
}

bool is_used_record(const std::string& name) {
  for (const std::string_view used : {"GPS", "ATT", "POS", "XKF1", "NKF1", "SIM", "CAM", "TRIG", "RFND", "TERR"}) {
    if (name == used) return true;
  }
  return false;
}

/// CAM says that a picture was taken, TRIG only that one was asked for.
void take_dataflash_record(const DataFlashRecord& record, const std::string& captures, LogBuilder& builder) {
  const std::string& name = record.name();
  const double time_s = record.time_s();
  if (name == "GPS") return take_dataflash_gnss(record, builder);
  if (name == "ATT") return builder.add_attitude(&VehicleLog::estimate, time_s, attitude_of(record));
  if (name == "POS") {
    return builder.add_position(&VehicleLog::estimate, time_s, record.number("Lat"), record.number("Lng"),
                                record.number("Alt"));
  }
  if (is_filter(name)) {
    return builder.add_velocity(&VehicleLog::estimate, time_s, record.number("VN"), record.number("VE"),
                                record.number("VD"));
  }
  if (name == "SIM") {
    builder.add_attitude(&VehicleLog::truth, time_s, attitude_of(record));
    return builder.add_position(&VehicleLog::truth, time_s, record.number("Lat"), record.number("Lng"),
                                record.number("Alt"));
  }
  if (name == "RFND") return take_range_finder(record, builder);
  if (name == "TERR") return take_terrain(record, builder);
  if (name == captures) return take_dataflash_capture(record, builder);
}

/// Walks over the records, and learns their formats on the way.
class DataFlashRecords {
 public:
  DataFlashRecords(std::string_view bytes, LogLosses& losses) : bytes_(bytes), losses_(losses) {}

  /// The next record whose format is known; its format stays valid until the object dies.
  bool next(const RecordFormat*& format, std::string_view& record) {
    while (at_ < bytes_.size()) {
      if (!read(format, record)) {
        skip();
        continue;
      }
      at_ += record.size();
      if (format != nullptr) return true;
    }
    return false;
  }

 private:
  /// Of a format record `format` is null.
  bool read(const RecordFormat*& format, std::string_view& record) {
    const std::string_view rest = bytes_.substr(at_);
    if (rest.size() < kRecordHead || !rest.starts_with(kRecordMagic)) return false;
    const auto id = static_cast<unsigned char>(rest[2]);
    const std::size_t size = id == kFormatId ? kFormatSize : formats_[id].size;
    if (size == 0) return false;
    if (size > rest.size()) {
      losses_.truncated = true;
      return false;
    }
    record = rest.substr(0, size);
    format = nullptr;
    if (id != kFormatId) {
      format = &formats_[id];
      return true;
    }
    const auto described = static_cast<unsigned char>(record[3]);
    if (described == kFormatId) return true;
    std::optional<RecordFormat> learnt = format_of(record);
    if (!learnt) return false;
    formats_[described] = *std::move(learnt);
    return true;
  }

  void skip() {
    const std::size_t next = std::min(bytes_.find(kRecordMagic, at_ + 1), bytes_.size());
    losses_.bytes_skipped += static_cast<std::int64_t>(next - at_);
    at_ = next;
  }

  std::string_view bytes_;
  LogLosses& losses_;
  std::size_t at_ = 0;
  std::array<RecordFormat, 256> formats_;
};

/// "CAM" when the log holds such records, else "TRIG".
std::string capture_record_of(std::string_view bytes) {
  LogLosses losses;
  DataFlashRecords records(bytes, losses);
  const RecordFormat* format = nullptr;
  std::string_view record;
  while (records.next(format, record)) {
    if (format->name == "CAM") return "CAM";
  }
  return "TRIG";
}

}  // namespace

bool is_dataflash_log(std::string_view bytes) {
  return bytes.size() >= kRecordHead && bytes.starts_with(kRecordMagic) &&
         static_cast<unsigned char>(bytes[2]) == kFormatId;
}

VehicleLog parse_dataflash_log(const std::string& name, std::string_view bytes) {
  if (!is_dataflash_log(bytes)) throw DataError(name + ": does not begin with a format record of a DataFlash log");
  const std::string captures = capture_record_of(bytes);
  LogBuilder builder(LogFormat::kDataFlash);
  DataFlashRecords records(bytes, builder.losses());
  const RecordFormat* format = nullptr;
  std::string_view bytes_of_record;
  while (records.next(format, bytes_of_record)) {
    if (!is_used_record(format->name)) continue;
    const DataFlashRecord record(*format, bytes_of_record);
    // Of range finders the builder chooses one.
    if (record.instance() != 0 && record.name() != "RFND") {
      builder.leave_out_source(record.name() + " " + std::to_string(record.instance()));
      continue;
    }
    if (builder.accept(record.time_s())) take_dataflash_record(record, captures, builder);
  }
  return builder.finish();
}

}  // namespace pilotage
