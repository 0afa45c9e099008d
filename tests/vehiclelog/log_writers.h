#pragma once

#include <bit>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/vehiclelog/mavlink_frame.h"
#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {

inline VehicleLog parse_flight(const std::string& bytes) {
  return parse_vehicle_log("flight", bytes, {});
}

/// Bytes, little endian.
class LogText {
 public:
  /// More than the eight bytes of `value` are zeros.
  LogText& u(std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) text_ += i < sizeof value ? static_cast<char>(value >> (8 * i)) : '\0';
    return *this;
  }
  LogText& i(std::int64_t value, std::size_t size) { return u(static_cast<std::uint64_t>(value), size); }
  LogText& f(double value) { return u(std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4); }
  LogText& d(double value) { return u(std::bit_cast<std::uint64_t>(value), 8); }
  LogText& text(std::string_view value) {
    text_ += value;
    return *this;
  }
  /// Filled with zeros.
  LogText& text(std::string_view value, std::size_t size) {
    text_ += value;
    text_.resize(text_.size() + size - value.size(), '\0');
    return *this;
  }
  const std::string& str() const { return text_; }

 private:
  std::string text_;
};

// ---- ULog

inline std::string ulog_message(char type, std::string_view body) {
  return LogText().u(body.size(), 2).u(static_cast<unsigned char>(type), 1).text(body).str();
}
inline std::string ulog_head() {
  return LogText().text("ULog\x01\x12\x35").u(1, 1).u(1000, 8).str();
}
inline std::string ulog_flags(std::uint64_t appended_at) {
  LogText flags;
  flags.u(0, 8).u(appended_at > 0 ? 1 : 0, 8).u(appended_at, 8).u(0, 16);
  return ulog_message('B', flags.str());
}
inline std::string ulog_format(std::string_view text) {
  return ulog_message('F', text);
}
inline std::string ulog_stream(unsigned id, std::string_view topic, unsigned instance = 0) {
  return ulog_message('A', LogText().u(instance, 1).u(id, 2).text(topic).str());
}
inline std::string ulog_record(unsigned id, const LogText& body) {
  return ulog_message('D', LogText().u(id, 2).text(body.str()).str());
}
inline std::string ulog_sync() {
  return ulog_message('S', "\x2F\x73\x13\x20\x25\x0C\xBB\x12");
}
inline LogText ulog_time(double time_s) {
  return LogText().u(static_cast<std::uint64_t>(time_s * 1e6), 8);
}

inline constexpr const char* kAttitudeFormat = "vehicle_attitude:uint64_t timestamp;float[4] q;uint8_t[4] _padding0;";
inline constexpr const char* kPositionFormat =
    "vehicle_global_position:uint64_t timestamp;double lat;double lon;float alt;";

/// Level, the nose to `yaw_deg`.
LogText ulog_attitude_record(double time_s, double yaw_deg);

/// Ten seconds eastward from 55.5° N 16.5° E, a position and an attitude each second, and a picture every second one.
std::string small_ulog();

// ---- DataFlash

std::string dataflash_format(unsigned id, std::string_view name, std::string_view letters, std::string_view labels);
inline std::string dataflash_record(unsigned id, const LogText& body) {
  return LogText().u(0xA3, 1).u(0x95, 1).u(id, 1).text(body.str()).str();
}
/// The same flight.
std::string small_dataflash();

// ---- Telemetry

/// A frame of version 1 or 2 behind its time; `extra` is the seed of the message's checksum.
std::string telemetry_record(int version, double time_s, std::uint32_t id, std::string payload, std::uint8_t extra,
                             std::uint8_t system = 1, std::uint8_t component = 1);
/// The same flight, version 1 and 2 by turns.
std::string small_telemetry();

// ---- AirSim

std::string small_airsim();

/// A log of each kind and damaged ones, by file name, as the corpus of the fuzz target of that reader.
std::map<std::string, std::string> fuzz_corpus(const std::string& reader);

}  // namespace pilotage
