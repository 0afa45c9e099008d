#pragma once

#include <string_view>

namespace pilotage {

/// What a mission command means for the path over the ground.
enum class CommandRole {
  kPath,             ///< Flown to.
  kTakeoff,          ///< Flown to; without a position it happens where the aircraft is.
  kLand,             ///< Flown to; without a position it happens where the aircraft is.
  kReturn,           ///< Flown to home.
  kJump,             ///< To item param1, param2 times.
  kJumpToTag,        ///< To tag param1, param2 times.
  kTag,              ///< Carries tag param1.
  kSpeed,            ///< Changes the speed.
  kClimb,            ///< Changes the height on the way.
  kPlaceNotFlownTo,  ///< Names a place that the aircraft does not fly to.
  kNoPlace,          ///< Has nothing to do with places.
  kLocal,            ///< A path in local coordinates: refused.
  kUnknown,
};

struct CommandInfo {
  int command;
  std::string_view name;
  CommandRole role;
};

/// PX4's number among the autopilots (MAV_AUTOPILOT).
inline constexpr int kPx4Autopilot = 12;

/// The entry of a MAV_CMD (MAVLink common.xml); role kUnknown and an empty name for commands not listed.
CommandInfo command_info(int command);

}  // namespace pilotage
