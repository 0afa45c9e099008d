// Frames of MAVLink (https://mavlink.io/en/guide/serialization.html) and the messages that this program hears and says,
// without generated headers. A program that has those uses them instead.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <pilotage/onboard.h>

namespace mavlink {

using Bytes = std::vector<std::uint8_t>;

/// CRC-16/MCRF4XX, which MAVLink calls X.25: of "123456789" it is 0x6F91.
std::uint16_t crc_x25(std::span<const std::uint8_t> bytes, std::uint16_t crc = 0xFFFF);

/// Numbers of messages (common.xml).
enum : std::uint32_t {
  kHeartbeat = 0,
  kGpsRawInt = 24,
  kAttitude = 30,
  kGlobalPositionInt = 33,
  kCommandInt = 75,
  kCommandLong = 76,
  kCommandAck = 77,
  kHighresImu = 105,
  kDistanceSensor = 132,
  kTerrainCheck = 135,
  kTerrainReport = 136,
  kGpsInput = 232,
  kStatustext = 253,
};

/// MAV_COMP_ID_AUTOPILOT1
constexpr std::uint8_t kAutopilotComponent = 1;

/// A message whose checksum holds. The payload has the definition's whole length: zeros that were left out at its end,
/// and members that an older sender does not know, are there.
struct Message {
  std::uint32_t id = 0;
  std::uint8_t system_id = 0;
  std::uint8_t component_id = 0;
  Bytes payload;
  Bytes frame;  ///< As it came.

  /// A member at its place on the wire. `Number`: an integer, or a float.
  template <class Number>
  Number at(std::size_t offset) const;
};

/// Whether a frame of MAVLink 1 or 2 may begin with this byte.
bool is_frame_start(std::uint8_t byte);
/// Of the whole frame that begins with these three bytes.
std::size_t frame_bytes(std::span<const std::uint8_t> begin);

/// Finds frames of MAVLink 1 and 2 in bytes as they come. Frames of messages that are not heard, and those whose
/// checksum is wrong, are passed over; signatures are not checked.
class Reader {
 public:
  void push(std::span<const std::uint8_t> bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }
  std::optional<Message> next();

 private:
  Bytes bytes_;
};

/// Who sends. The sequence counts all messages of a sender.
struct Sender {
  std::uint8_t system_id = 1;  ///< That of the aircraft: whom it speaks to, too.
  std::uint8_t component_id = 191;
  std::uint8_t sequence = 0;
};

Bytes heartbeat(Sender& sender);

/// Severities of STATUSTEXT.
enum : std::uint8_t { kWarning = 4, kNotice = 5 };
/// At most 50 bytes of the text.
Bytes statustext(Sender& sender, std::uint8_t severity, const std::string& text);

/// MAV_CMD_SET_MESSAGE_INTERVAL: asks the autopilot for a message so often.
Bytes message_interval(Sender& sender, std::uint32_t message_id, double rate_hz);

/// Asks for the height of the ground at a place (TERRAIN_REPORT).
Bytes terrain_check(Sender& sender, const pilotage::GeodeticPoint& place);

/// A position for an autopilot that is to take it for a GPS receiver's. There is no velocity in it: one made of the
/// same positions would count them twice, and teach the autopilot a false wind. No time either, no dilution of
/// precision, and no satellites.
struct GpsInput {
  std::uint64_t time_us = 0;
  std::uint8_t gps_id = 0;
  bool has_fix = false;  ///< A three-dimensional one, or none.
  pilotage::GeodeticPoint position;
  double amsl_m = 0;
  double horizontal_sigma_m = 0;
  double vertical_sigma_m = 0;
};
Bytes gps_input(Sender& sender, const GpsInput& input);

/// MAV_CMD_EXTERNAL_POSITION_ESTIMATE (43003): where the aircraft was `processing_time_s` before the sending.
struct ExternalPositionEstimate {
  double sending_time_s =
      0;  ///< By the sender's clock; it begins anew every four hours on the wire, for want of digits.
  double processing_time_s = 0;
  double sigma_m = 0;
  pilotage::GeodeticPoint position;
};
constexpr std::uint16_t kExternalPositionEstimate = 43003;
Bytes external_position_estimate(Sender& sender, const ExternalPositionEstimate& estimate);

Bytes global_position_sensor(Sender& sender, const pilotage::MavlinkGlobalPositionSensor& message);

}  // namespace mavlink
