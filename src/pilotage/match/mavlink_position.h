#pragma once

#include <cstdint>
#include <limits>

#include "pilotage/match/fix_altitude.h"
#include "pilotage/match/match.h"

#pragma GCC visibility push(default)

namespace pilotage {

inline constexpr std::uint32_t kMavlinkGlobalPositionSensorId = 296;

/// GLOBAL_POSITION_SRC of MAVLink's common.xml.
enum class MavlinkPositionSource : std::uint8_t {
  kUnknown = 0,
  kGnss = 1,
  kVision = 2,
  kPseudolites = 3,
  kTerrain = 4,
  kMagnetic = 5,
  kEstimator = 6,
};

/// GLOBAL_POSITION_FLAGS of MAVLink's common.xml, a bit mask.
inline constexpr std::uint8_t kMavlinkPositionUnhealthy = 1;
inline constexpr std::uint8_t kMavlinkPositionPrimary = 2;

/// The fields of GLOBAL_POSITION_SENSOR (message 296 of MAVLink 2, common.xml), with their names, types and units, in
/// the order of its definition (not of its wire format): copy them one by one into the generated struct.
struct MavlinkGlobalPositionSensor {
  std::uint8_t target_system = 0;     ///< The autopilot's system ID; 0 = everybody.
  std::uint8_t target_component = 0;  ///< "Normally 0 for broadcast".
  std::uint8_t id = 0;                ///< Which sensor of this kind.
  std::uint64_t time_usec = 0;        ///< µs: when the message is sent, since 1970 or since boot.
  std::uint32_t processing_time = 0;  ///< µs from the exposure of the frame to time_usec.
  MavlinkPositionSource source = MavlinkPositionSource::kVision;
  std::uint8_t flags = kMavlinkPositionUnhealthy;
  std::int32_t lat = std::numeric_limits<std::int32_t>::max();    ///< degrees · 1e7, WGS 84; INT32_MAX = invalid.
  std::int32_t lon = std::numeric_limits<std::int32_t>::max();    ///< degrees · 1e7, in [-180°, 180°).
  float alt_ellipsoid = std::numeric_limits<float>::quiet_NaN();  ///< m above the WGS 84 ellipsoid; NaN = not known.
  float alt = std::numeric_limits<float>::quiet_NaN();  ///< m above mean sea level, for want of alt_ellipsoid; NaN.
  float eph = std::numeric_limits<float>::quiet_NaN();  ///< m: standard deviation of the horizontal position.
  float epv = std::numeric_limits<float>::quiet_NaN();  ///< m: standard deviation of the altitude.
};

/// Who sends, to whom, and when.
struct MavlinkSending {
  std::uint8_t target_system = 0;
  std::uint8_t target_component = 0;
  std::uint8_t sensor_id = 0;
  std::uint64_t exposure_time_us = 0;  ///< When the frame was taken, by the clock of sending_time_us.
  std::uint64_t sending_time_us = 0;   ///< Not before the exposure.
};

/// The message by which an autopilot gets a match: the position of the aircraft (Fix::position), source VISION.
///
/// `eph` is one number where the covariance has three: the root of its largest eigenvalue, because autopilots apply it
/// to each axis. Latitude and longitude are rounded to the nearest 1e-7 degrees (at most 6 mm). A match without a fix,
/// or with numbers that are not finite, gives a message with the flag UNHEALTHY, invalid position and NaN for the
/// rest: it may be sent to show that the sensor lives, or dropped. Why there is no fix is in MatchResult::status; the
/// message has no field for it. MatchResult::candidate is never used. A processing time longer than the field holds
/// (71 minutes), or an exposure after the sending, is held to the field's range. Pure; never throws.
///
/// Source: MAVLink common.xml, GLOBAL_POSITION_SENSOR, GLOBAL_POSITION_SRC, GLOBAL_POSITION_FLAGS
/// (https://mavlink.io/en/messages/common.html#GLOBAL_POSITION_SENSOR). Its text asks for NaN where processing_time is
/// not known, which an integer cannot hold; here it always is known.
MavlinkGlobalPositionSensor mavlink_global_position_sensor(const MatchResult& result, const FixAltitude& altitude,
                                                           const MavlinkSending& sending);

}  // namespace pilotage

#pragma GCC visibility pop
