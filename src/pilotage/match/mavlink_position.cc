#include "pilotage/match/mavlink_position.h"

#include <algorithm>
#include <cmath>

#include "pilotage/match/usable_fix.h"

namespace pilotage {
namespace {

constexpr double kUnitsPerDegree = 1e7;

std::uint32_t processing_time_us(const MavlinkSending& sending) {
  if (sending.sending_time_us < sending.exposure_time_us) return 0;
  constexpr std::uint64_t kMax = std::numeric_limits<std::uint32_t>::max();
  return static_cast<std::uint32_t>(std::min(sending.sending_time_us - sending.exposure_time_us, kMax));
}

std::int32_t degrees_e7(double degrees) {
  return static_cast<std::int32_t>(std::llround(degrees * kUnitsPerDegree));
}

float known_or_nan(double number) {
  return std::isfinite(number) ? static_cast<float>(number) : std::numeric_limits<float>::quiet_NaN();
}

/// Root of the larger eigenvalue of a symmetric 2 × 2 matrix.
double largest_sigma(const Eigen::Matrix2d& covariance) {
  const double mean = (covariance(0, 0) + covariance(1, 1)) / 2;
  const double half_difference = (covariance(0, 0) - covariance(1, 1)) / 2;
  return std::sqrt(mean + std::hypot(half_difference, covariance(0, 1)));
}

}  // namespace

MavlinkGlobalPositionSensor mavlink_global_position_sensor(const MatchResult& result, const FixAltitude& altitude,
                                                           const MavlinkSending& sending) {
  MavlinkGlobalPositionSensor message;
  message.target_system = sending.target_system;
  message.target_component = sending.target_component;
  message.id = sending.sensor_id;
  message.time_usec = sending.sending_time_us;
  message.processing_time = processing_time_us(sending);
  if (!has_usable_fix(result)) return message;
  message.flags = 0;
  message.lat = degrees_e7(result.fix->position.lat_deg);
  message.lon = degrees_e7(wrap_lon_deg(result.fix->position.lon_deg));
  constexpr std::int32_t kAntimeridian = 1'800'000'000;
  if (message.lon == kAntimeridian) message.lon = -kAntimeridian;  // just below 180°, rounded up
  message.eph = static_cast<float>(largest_sigma(result.fix->covariance_en_m2));
  message.alt_ellipsoid = known_or_nan(altitude.ellipsoid_m);
  message.alt = known_or_nan(altitude.amsl_m);
  const bool altitude_known = !std::isnan(message.alt_ellipsoid) || !std::isnan(message.alt);
  if (altitude_known) message.epv = known_or_nan(altitude.sigma_m);
  return message;
}

}  // namespace pilotage
