#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace pilotage {

/// A frame of MAVLink 1 or 2 (mavlink.io, "Packet Serialization").
struct MavlinkFrame {
  std::uint32_t message_id = 0;
  std::uint8_t system_id = 0;
  std::uint8_t component_id = 0;
  std::string_view payload;    ///< As sent: MAVLink 2 leaves out zeros at its end.
  std::size_t size = 0;        ///< Of the whole frame.
  bool checksum_holds = true;  ///< Of the messages of mavlink_crc_extra(); others cannot be checked.
};

/// The seed by which sender and reader of a message agree on its fields: of the messages that logs are read for.
std::optional<std::uint8_t> mavlink_crc_extra(std::uint32_t message_id);

/// CRC-16/MCRF4XX over `bytes`, carried on from `crc`.
std::uint16_t mavlink_crc(std::string_view bytes, std::uint16_t crc = 0xFFFF);

/// The frame at the beginning of `bytes`; nothing when there is none, or not all of it.
std::optional<MavlinkFrame> read_mavlink_frame(std::string_view bytes);

/// The payload with the zeros that were left out, so that it has at least `size` bytes.
std::string whole_payload(std::string_view payload, std::size_t size);

}  // namespace pilotage
