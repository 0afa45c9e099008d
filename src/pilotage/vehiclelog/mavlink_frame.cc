#include "pilotage/vehiclelog/mavlink_frame.h"

#include <algorithm>

#include "pilotage/vehiclelog/log_bytes.h"

namespace pilotage {
namespace {

struct FrameShape {
  std::size_t head;
  std::size_t id_offset;
  std::size_t id_size;
  std::size_t system_offset;
};
constexpr FrameShape kVersion1{6, 5, 1, 3};
constexpr FrameShape kVersion2{10, 7, 3, 5};
constexpr std::size_t kChecksumSize = 2;
constexpr std::size_t kSignatureSize = 13;

}  // namespace

std::optional<std::uint8_t> mavlink_crc_extra(std::uint32_t message_id) {
  switch (message_id) {
    case 0:  // HEARTBEAT
      return 50;
    case 24:  // GPS_RAW_INT
      return 24;
    case 30:  // ATTITUDE
      return 39;
    case 32:  // LOCAL_POSITION_NED
      return 185;
    case 33:  // GLOBAL_POSITION_INT
      return 104;
    case 112:  // CAMERA_TRIGGER
      return 174;
    case 132:  // DISTANCE_SENSOR
      return 85;
    case 180:  // CAMERA_FEEDBACK
      return 52;
    case 263:  // CAMERA_IMAGE_CAPTURED
      return 133;
    default:
      return std::nullopt;
  }
}

std::uint16_t mavlink_crc(std::string_view bytes, std::uint16_t crc) {
  for (const char byte : bytes) {
    auto mixed = static_cast<std::uint8_t>(static_cast<std::uint8_t>(byte) ^ (crc & 0xFF));
    mixed = static_cast<std::uint8_t>(mixed ^ (mixed << 4));
    crc = static_cast<std::uint16_t>((crc >> 8) ^ (mixed << 8) ^ (mixed << 3) ^ (mixed >> 4));
  }
  return crc;
}

std::optional<MavlinkFrame> read_mavlink_frame(std::string_view bytes) {
  if (bytes.empty()) return std::nullopt;
  const bool is_first = bytes[0] == '\xFE';
  if (!is_first && bytes[0] != '\xFD') return std::nullopt;
  const FrameShape& shape = is_first ? kVersion1 : kVersion2;
  if (bytes.size() < shape.head) return std::nullopt;
  const auto incompatible = is_first ? 0U : static_cast<unsigned char>(bytes[2]);
  if ((incompatible & ~1U) != 0) return std::nullopt;  // a flag that changes the frame in an unknown way
  const auto length = static_cast<std::size_t>(static_cast<unsigned char>(bytes[1]));
  MavlinkFrame frame;
  frame.size = shape.head + length + kChecksumSize + ((incompatible & 1U) != 0 ? kSignatureSize : 0);
  if (bytes.size() < frame.size) return std::nullopt;
  frame.message_id = static_cast<std::uint32_t>(unsigned_at(bytes, shape.id_offset, shape.id_size));
  frame.system_id = static_cast<std::uint8_t>(bytes[shape.system_offset]);
  frame.component_id = static_cast<std::uint8_t>(bytes[shape.system_offset + 1]);
  frame.payload = bytes.substr(shape.head, length);
  if (const auto extra = mavlink_crc_extra(frame.message_id)) {
    const char last = static_cast<char>(*extra);
    const std::uint16_t crc = mavlink_crc({&last, 1}, mavlink_crc(bytes.substr(1, shape.head - 1 + length)));
    frame.checksum_holds = crc == unsigned_at(bytes, shape.head + length, kChecksumSize);
  }
  return frame;
}

std::string whole_payload(std::string_view payload, std::size_t size) {
  std::string whole(payload);
  whole.resize(std::max(size, payload.size()), '\0');
  return whole;
}

}  // namespace pilotage
