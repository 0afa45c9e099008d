#pragma once

#include <string>
#include <vector>

#include "pilotage/base/options.h"

#pragma GCC visibility push(default)

namespace pilotage {

struct Report;

/// What flies the aircraft, and what kind it is: that decides how long it flies without a position.
enum class Autopilot { kPx4Multicopter, kPx4FixedWing, kArducopter, kArduplane };
inline EnumNames<Autopilot> enum_names(Autopilot) {
  return {{Autopilot::kPx4Multicopter, "px4-multicopter"},
          {Autopilot::kPx4FixedWing, "px4-fixed-wing"},
          {Autopilot::kArducopter, "arducopter"},
          {Autopilot::kArduplane, "arduplane"}};
}

inline constexpr const char* kAutopilotHelp =
    "What the aircraft flies with: warns where it stays longer without a position by sight than it is willing to, and "
    "--outputs autopilot writes parameters for it.";

bool is_px4(Autopilot autopilot);

/// Where the aircraft stays without a position by sight longer than its autopilot does without one, a sentence each;
/// empty where it does not. Of the gaps that part counts in which GNSS is denied, and one more interval of fixes. Times
/// are the autopilots' (docs/methods/autopilots.md has the sources); `report` has its gaps, legs and denied stretches.
std::vector<std::string> autopilot_warnings(const Report& report, Autopilot autopilot);

/// The parameters by which the autopilot takes positions by sight, with a comment for each, and autopilot_warnings():
/// a file for QGroundControl (PX4) or Mission Planner (ArduPilot).
std::string autopilot_parameters(const Report& report, Autopilot autopilot);

}  // namespace pilotage

#pragma GCC visibility pop
