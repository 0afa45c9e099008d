#pragma once

#include <numbers>

namespace pilotage {

inline constexpr double kRadPerDeg = std::numbers::pi / 180;

}  // namespace pilotage
