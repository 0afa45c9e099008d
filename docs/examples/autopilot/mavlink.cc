#include "mavlink.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>

namespace mavlink {
namespace {

/// Of a message that is heard: what its definition adds to the checksum, and the length of its payload, with what
/// MAVLink 2 put behind it.
struct Heard {
  std::uint8_t crc_extra;
  std::size_t length;
};
const std::map<std::uint32_t, Heard> kHeard = {
    {kHeartbeat, {50, 9}},    {kGpsRawInt, {24, 52}},  {kAttitude, {39, 28}},       {kGlobalPositionInt, {104, 28}},
    {kCommandAck, {143, 10}}, {kHighresImu, {93, 63}}, {kDistanceSensor, {85, 39}}, {kTerrainReport, {1, 22}},
};

constexpr std::uint8_t kVersion1 = 0xFE;
constexpr std::uint8_t kVersion2 = 0xFD;
constexpr std::size_t kHeader1Bytes = 6;
constexpr std::size_t kHeader2Bytes = 10;

/// The lowest `count` bytes, the least first.
void put(Bytes& bytes, std::uint64_t number, int count) {
  for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::uint8_t>(number >> (8 * i)));
}

void put_floats(Bytes& bytes, std::initializer_list<double> numbers) {
  for (const double number : numbers) put(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(number)), 4);
}

void put_degrees_e7(Bytes& bytes, double degrees) {
  put(bytes, static_cast<std::uint32_t>(static_cast<std::int32_t>(std::llround(degrees * 1e7))), 4);
}

/// `crc_extra`: of the message's definition, so that a receiver with another one refuses it.
Bytes frame_of(Sender& sender, std::uint32_t message_id, std::uint8_t crc_extra, Bytes payload) {
  while (payload.size() > 1 && payload.back() == 0) payload.pop_back();  // as MAVLink 2 has it
  Bytes frame = {
      kVersion2,          static_cast<std::uint8_t>(payload.size()), 0, 0, sender.sequence++, sender.system_id,
      sender.component_id};
  put(frame, message_id, 3);
  frame.insert(frame.end(), payload.begin(), payload.end());
  const std::uint8_t extra[] = {crc_extra};
  put(frame, crc_x25(extra, crc_x25(std::span(frame).subspan(1))), 2);
  return frame;
}

}  // namespace

std::uint16_t crc_x25(std::span<const std::uint8_t> bytes, std::uint16_t crc) {
  for (const std::uint8_t byte : bytes) {
    auto mixed = static_cast<std::uint8_t>(byte ^ (crc & 0xFF));
    mixed = static_cast<std::uint8_t>(mixed ^ (mixed << 4));
    crc = static_cast<std::uint16_t>((crc >> 8) ^ (mixed << 8) ^ (mixed << 3) ^ (mixed >> 4));
  }
  return crc;
}

bool is_frame_start(std::uint8_t byte) {
  return byte == kVersion1 || byte == kVersion2;
}

std::size_t frame_bytes(std::span<const std::uint8_t> begin) {
  constexpr std::uint8_t kSigned = 1;
  constexpr std::size_t kChecksumBytes = 2, kSignatureBytes = 13;
  if (begin[0] == kVersion1) return kHeader1Bytes + begin[1] + kChecksumBytes;
  return kHeader2Bytes + begin[1] + kChecksumBytes + ((begin[2] & kSigned) != 0 ? kSignatureBytes : 0);
}

template <class Number>
Number Message::at(std::size_t offset) const {
  Number number{};
  std::memcpy(&number, payload.data() + offset, sizeof(Number));
  static_assert(std::endian::native == std::endian::little, "MAVLink's members stand the least byte first");
  return number;
}
template std::uint8_t Message::at(std::size_t) const;
template std::int16_t Message::at(std::size_t) const;
template std::uint16_t Message::at(std::size_t) const;
template std::int32_t Message::at(std::size_t) const;
template std::uint32_t Message::at(std::size_t) const;
template std::uint64_t Message::at(std::size_t) const;
template float Message::at(std::size_t) const;

std::optional<Message> Reader::next() {
  std::size_t begin = 0;
  std::optional<Message> found;
  while (!found) {
    while (begin < bytes_.size() && !is_frame_start(bytes_[begin])) ++begin;
    const std::span<const std::uint8_t> rest = std::span<const std::uint8_t>(bytes_).subspan(begin);
    if (rest.size() < 3 || rest.size() < frame_bytes(rest)) break;
    const auto frame = rest.first(frame_bytes(rest));
    const bool newer = frame[0] == kVersion2;
    const std::size_t sender = newer ? 5 : 3;  // system and component; behind them the message's number
    const std::uint32_t id =
        frame[sender + 2] |
        (newer ? std::uint32_t{frame[sender + 3]} << 8 | std::uint32_t{frame[sender + 4]} << 16 : 0);
    const auto heard = kHeard.find(id);
    if (heard == kHeard.end()) {
      // It may be no frame at all: only a checksum tells, for which the definition is wanted. Frames of others are far
      // more frequent than bytes of none.
      begin += frame.size();
      continue;
    }
    const auto payload = frame.subspan(newer ? kHeader2Bytes : kHeader1Bytes, frame[1]);
    const auto checked = frame.first(static_cast<std::size_t>(payload.end() - frame.begin()));
    const std::uint8_t extra[] = {heard->second.crc_extra};
    const std::uint16_t crc = crc_x25(extra, crc_x25(checked.subspan(1)));
    if (frame[checked.size()] != (crc & 0xFF) || frame[checked.size() + 1] != crc >> 8) {
      ++begin;
      continue;
    }
    found = Message{id, frame[sender], frame[sender + 1], Bytes(payload.begin(), payload.end()),
                    Bytes(frame.begin(), frame.end())};
    found->payload.resize(heard->second.length);
    begin += frame.size();
  }
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(begin));
  return found;
}

Bytes heartbeat(Sender& sender) {
  constexpr std::uint8_t kOnboardController = 18;
  constexpr std::uint8_t kNoAutopilot = 8;
  constexpr std::uint8_t kActive = 4;
  constexpr std::uint8_t kMavlinkVersion = 3;
  Bytes payload;
  put(payload, 0, 4);
  for (const std::uint8_t byte : {kOnboardController, kNoAutopilot, std::uint8_t{0}, kActive, kMavlinkVersion}) {
    payload.push_back(byte);
  }
  return frame_of(sender, kHeartbeat, 50, payload);
}

Bytes statustext(Sender& sender, std::uint8_t severity, const std::string& text) {
  Bytes payload = {severity};
  payload.insert(payload.end(), text.begin(),
                 text.begin() + static_cast<std::ptrdiff_t>(std::min<std::size_t>(text.size(), 50)));
  return frame_of(sender, kStatustext, 83, payload);
}

Bytes message_interval(Sender& sender, std::uint32_t message_id, double rate_hz) {
  constexpr std::uint16_t kSetMessageInterval = 511;
  Bytes payload;
  put_floats(payload, {static_cast<double>(message_id), 1e6 / rate_hz, 0, 0, 0, 0, 0});
  put(payload, kSetMessageInterval, 2);
  payload.insert(payload.end(), {sender.system_id, kAutopilotComponent, 0});
  return frame_of(sender, kCommandLong, 152, payload);
}

Bytes terrain_check(Sender& sender, const pilotage::GeodeticPoint& place) {
  Bytes payload;
  put_degrees_e7(payload, place.lat_deg);
  put_degrees_e7(payload, pilotage::wrap_lon_deg(place.lon_deg));
  return frame_of(sender, kTerrainCheck, 203, payload);
}

Bytes gps_input(Sender& sender, const GpsInput& input) {
  // GPS_INPUT_IGNORE_FLAGS: dilution of precision, both velocities, accuracy of the speed.
  constexpr std::uint16_t kIgnored = 2 | 4 | 8 | 16 | 32;
  constexpr std::uint8_t kFix3d = 3;
  constexpr std::uint8_t kNoFix = 1;
  Bytes payload;
  put(payload, input.time_us, 8);
  put(payload, 0, 4);  // of the week: 0 with week 0 says that no GPS time is known
  put_degrees_e7(payload, input.position.lat_deg);
  put_degrees_e7(payload, pilotage::wrap_lon_deg(input.position.lon_deg));
  put_floats(payload, {input.amsl_m, 0, 0, 0, 0, 0, 0, input.horizontal_sigma_m, input.vertical_sigma_m});
  put(payload, kIgnored, 2);
  put(payload, 0, 2);  // week
  payload.insert(payload.end(), {input.gps_id, input.has_fix ? kFix3d : kNoFix, 0});
  put(payload, 0, 2);  // yaw: not known
  return frame_of(sender, kGpsInput, 151, payload);
}

Bytes external_position_estimate(Sender& sender, const ExternalPositionEstimate& estimate) {
  constexpr double kWrap_s = 14400;  // 1 ms in 24 bits
  const double not_known = std::numeric_limits<double>::quiet_NaN();
  Bytes payload;
  put_floats(payload,
             {std::fmod(estimate.sending_time_s, kWrap_s), estimate.processing_time_s, estimate.sigma_m, not_known});
  put_degrees_e7(payload, estimate.position.lat_deg);
  put_degrees_e7(payload, pilotage::wrap_lon_deg(estimate.position.lon_deg));
  put_floats(payload, {not_known});
  put(payload, kExternalPositionEstimate, 2);
  payload.insert(payload.end(), {sender.system_id, kAutopilotComponent, 0, 0, 0});  // MAV_FRAME_GLOBAL
  return frame_of(sender, kCommandInt, 158, payload);
}

Bytes global_position_sensor(Sender& sender, const pilotage::MavlinkGlobalPositionSensor& message) {
  // On the wire the members stand by their size, not as in the definition.
  Bytes payload;
  put(payload, message.time_usec, 8);
  put(payload, message.processing_time, 4);
  for (const std::int32_t degrees_e7 : {message.lat, message.lon}) {
    put(payload, static_cast<std::uint32_t>(degrees_e7), 4);
  }
  put_floats(payload, {message.alt_ellipsoid, message.alt, message.eph, message.epv});
  payload.insert(payload.end(), {message.target_system, message.target_component, message.id,
                                 static_cast<std::uint8_t>(message.source), message.flags});
  return frame_of(sender, pilotage::kMavlinkGlobalPositionSensorId, 158, payload);
}

}  // namespace mavlink
