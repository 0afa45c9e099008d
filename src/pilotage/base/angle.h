#pragma once

#include <array>
#include <cmath>
#include <numbers>

namespace pilotage {

inline constexpr double kRadPerDeg = std::numbers::pi / 180;

/// The nearest of eight points of the compass, such as "north-east"; `azimuth_deg` clockwise from north, finite.
inline const char* compass_name(double azimuth_deg) {
  static constexpr std::array<const char*, 8> kPoints{"north", "north-east", "east", "south-east",
                                                      "south", "south-west", "west", "north-west"};
  const double turn_deg = azimuth_deg - 360 * std::floor(azimuth_deg / 360);
  return kPoints[static_cast<std::size_t>(std::lround(turn_deg / 45)) % 8];
}

}  // namespace pilotage
