#include "pilotage/match/nav_sat_fix.h"

#include <algorithm>
#include <cmath>

#include "pilotage/match/usable_fix.h"

namespace pilotage {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

void set_stamp(std::int64_t time_ns, NavSatFix& message) {
  std::int64_t seconds = time_ns / kNsPerSecond;
  std::int64_t rest_ns = time_ns % kNsPerSecond;
  if (rest_ns < 0) {  // before 1970 the rest still counts forwards
    --seconds;
    rest_ns += kNsPerSecond;
  }
  using Seconds = std::numeric_limits<std::int32_t>;
  message.stamp_sec = static_cast<std::int32_t>(std::clamp<std::int64_t>(seconds, Seconds::min(), Seconds::max()));
  message.stamp_nanosec = static_cast<std::uint32_t>(rest_ns);
}

}  // namespace

NavSatFix nav_sat_fix(const MatchResult& result, const FixAltitude& altitude, std::int64_t exposure_time_ns,
                      const std::string& frame_id) {
  NavSatFix message;
  set_stamp(exposure_time_ns, message);
  message.frame_id = frame_id;
  if (!has_usable_fix(result)) return message;
  message.status = kNavSatStatusFix;
  message.latitude = result.fix->position.lat_deg;
  message.longitude = wrap_lon_deg(result.fix->position.lon_deg);
  message.altitude = std::isfinite(altitude.ellipsoid_m) ? altitude.ellipsoid_m : message.altitude;
  const bool altitude_known = std::isfinite(altitude.ellipsoid_m) && std::isfinite(altitude.sigma_m);
  const Eigen::Matrix2d& en = result.fix->covariance_en_m2;
  const double up_m2 = altitude_known ? altitude.sigma_m * altitude.sigma_m : kUnknownAltitudeVariance_m2;
  message.position_covariance = {en(0, 0), en(0, 1), 0, en(1, 0), en(1, 1), 0, 0, 0, up_m2};
  message.position_covariance_type = altitude_known ? kNavSatCovarianceKnown : kNavSatCovarianceApproximated;
  return message;
}

}  // namespace pilotage
