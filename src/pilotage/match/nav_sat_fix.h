#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <string>

#include "pilotage/match/fix_altitude.h"
#include "pilotage/match/match.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The constants of sensor_msgs/NavSatStatus and sensor_msgs/NavSatFix that are used here.
inline constexpr std::int8_t kNavSatStatusNoFix = -1;
inline constexpr std::int8_t kNavSatStatusFix = 0;
inline constexpr std::uint16_t kNavSatServiceUnknown = 0;  ///< No satellite system took part.
inline constexpr std::uint8_t kNavSatCovarianceUnknown = 0;
inline constexpr std::uint8_t kNavSatCovarianceApproximated = 1;
inline constexpr std::uint8_t kNavSatCovarianceKnown = 3;

/// Stands for the variance of an altitude that is not known (σ = 10 km): filters take no NaN in a covariance.
inline constexpr double kUnknownAltitudeVariance_m2 = 1e8;

/// The fields of the ROS 2 message sensor_msgs/msg/NavSatFix with their names, types and units; header and status are
/// flattened (header.stamp.sec is stamp_sec, status.status is status).
struct NavSatFix {
  std::int32_t stamp_sec = 0;       ///< When the frame was taken: seconds since 1970 (builtin_interfaces/Time),
  std::uint32_t stamp_nanosec = 0;  ///< and what is left, in [0, 1e9).
  std::string frame_id;             ///< What `latitude` … are of: the camera's frame, usually "base_link".
  std::int8_t status = kNavSatStatusNoFix;
  std::uint16_t service = kNavSatServiceUnknown;
  double latitude = std::numeric_limits<double>::quiet_NaN();   ///< Degrees, north positive.
  double longitude = std::numeric_limits<double>::quiet_NaN();  ///< Degrees, east positive, in [-180, 180).
  double altitude = std::numeric_limits<double>::quiet_NaN();   ///< m above the WGS 84 ellipsoid; NaN = not known.
  std::array<double, 9> position_covariance{};                  ///< m², row-major, east, north, up.
  std::uint8_t position_covariance_type = kNavSatCovarianceUnknown;
};

/// The message by which a ROS system gets a match: the position of the aircraft (Fix::position) at `exposure_time_ns`
/// (since 1970, held to what stamp_sec can say: until 2038).
///
/// The covariance holds the fix's east and north, and the altitude's variance; between them it is 0, since Fix has no
/// such terms. Its type is KNOWN, or APPROXIMATED with kUnknownAltitudeVariance_m2 where the altitude above the
/// ellipsoid or its error is not known. A match without a fix, or with numbers that are not finite, gives NO_FIX with a
/// position of NaN and a covariance of type UNKNOWN; why is in MatchResult::status, the message has no field for it.
/// MatchResult::candidate is never used. Pure; throws nothing but std::bad_alloc.
///
/// Source: sensor_msgs/msg/NavSatFix.msg and NavSatStatus.msg of ROS 2's common_interfaces
/// (https://docs.ros.org/en/rolling/p/sensor_msgs/msg/NavSatFix.html). ROS 1 has the same fields and values.
NavSatFix nav_sat_fix(const MatchResult& result, const FixAltitude& altitude, std::int64_t exposure_time_ns,
                      const std::string& frame_id);

}  // namespace pilotage

#pragma GCC visibility pop
