#pragma once

#include "pilotage/base/options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What flies the aircraft, and what kind of aircraft it is: that decides how long it flies without a position.
enum class Autopilot { kPx4Multicopter, kPx4FixedWing, kArducopter, kArduplane };
inline EnumNames<Autopilot> enum_names(Autopilot) {
  return {{Autopilot::kPx4Multicopter, "px4-multicopter"},
          {Autopilot::kPx4FixedWing, "px4-fixed-wing"},
          {Autopilot::kArducopter, "arducopter"},
          {Autopilot::kArduplane, "arduplane"}};
}

inline constexpr const char* kAutopilotHelp =
    "What the aircraft flies with: the report warns where it stays longer without a position by sight than that is "
    "willing to, and --outputs autopilot has its parameters.";

}  // namespace pilotage

#pragma GCC visibility pop
