// Frames of MAVLink 2 (https://mavlink.io/en/guide/serialization.html) for the two messages of this example, without
// generated headers. Copy it, or use those and mavlink_msg_global_position_sensor_encode().
#pragma once

#include <bit>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <vector>

#include <pilotage/onboard.h>

namespace mavlink_example {

using Bytes = std::vector<std::uint8_t>;

/// CRC-16/MCRF4XX, which MAVLink calls X.25: of "123456789" it is 0x6F91.
inline std::uint16_t crc_x25(std::span<const std::uint8_t> bytes, std::uint16_t crc = 0xFFFF) {
  for (const std::uint8_t byte : bytes) {
    auto mixed = static_cast<std::uint8_t>(byte ^ (crc & 0xFF));
    mixed = static_cast<std::uint8_t>(mixed ^ (mixed << 4));
    crc = static_cast<std::uint16_t>((crc >> 8) ^ (mixed << 8) ^ (mixed << 3) ^ (mixed >> 4));
  }
  return crc;
}

/// Who sends. The sequence counts all messages of a sender.
struct Sender {
  std::uint8_t system_id = 1;       ///< That of the aircraft.
  std::uint8_t component_id = 191;  ///< MAV_COMP_ID_ONBOARD_COMPUTER
  std::uint8_t sequence = 0;
};

/// The lowest `count` bytes, the least first.
inline void put(Bytes& bytes, std::uint64_t number, int count) {
  for (int i = 0; i < count; ++i) bytes.push_back(static_cast<std::uint8_t>(number >> (8 * i)));
}

/// `crc_extra`: of the message's definition, so that a receiver with another one refuses it.
inline Bytes make_frame(Sender& sender, std::uint32_t message_id, std::uint8_t crc_extra, Bytes payload) {
  while (payload.size() > 1 && payload.back() == 0) payload.pop_back();  // as MAVLink 2 has it
  Bytes frame = {
      0xFD, static_cast<std::uint8_t>(payload.size()), 0, 0, sender.sequence++, sender.system_id, sender.component_id};
  put(frame, message_id, 3);
  frame.insert(frame.end(), payload.begin(), payload.end());
  const std::uint8_t extra[] = {crc_extra};
  put(frame, crc_x25(extra, crc_x25(std::span(frame).subspan(1))), 2);
  return frame;
}

/// HEARTBEAT (0) of an onboard controller that is active: who sends nothing else is taken for gone.
inline Bytes heartbeat(Sender& sender) {
  constexpr std::uint8_t kOnboardController = 18;
  constexpr std::uint8_t kNoAutopilot = 8;
  constexpr std::uint8_t kActive = 4;
  constexpr std::uint8_t kMavlinkVersion = 3;
  Bytes payload;
  put(payload, 0, 4);
  payload.insert(payload.end(), {kOnboardController, kNoAutopilot, 0, kActive, kMavlinkVersion});
  return make_frame(sender, 0, 50, payload);
}

/// GLOBAL_POSITION_SENSOR (296): on the wire the members stand by their size, not as in the definition.
inline Bytes position_frame(Sender& sender, const pilotage::MavlinkGlobalPositionSensor& message) {
  Bytes payload;
  put(payload, message.time_usec, 8);
  put(payload, message.processing_time, 4);
  for (const std::int32_t degrees_e7 : {message.lat, message.lon}) {
    put(payload, static_cast<std::uint32_t>(degrees_e7), 4);
  }
  for (const float metres : {message.alt_ellipsoid, message.alt, message.eph, message.epv}) {
    put(payload, std::bit_cast<std::uint32_t>(metres), 4);
  }
  payload.insert(payload.end(), {message.target_system, message.target_component, message.id,
                                 static_cast<std::uint8_t>(message.source), message.flags});
  return make_frame(sender, pilotage::kMavlinkGlobalPositionSensorId, 158, payload);
}

}  // namespace mavlink_example
