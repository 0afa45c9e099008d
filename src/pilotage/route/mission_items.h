#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// One MAVLink mission item as a file holds it.
struct MissionItem {
  int index = 0;     ///< RouteItem::index: several mission items of one survey share it.
  int sequence = 0;  ///< The number that DO_JUMP calls it by.
  int command = 0;   ///< MAV_CMD.
  int frame = 0;     ///< MAV_FRAME.
  /// param1 … param4, latitude, longitude, altitude; NaN where the file has null.
  std::array<double, 7> params{};
  std::string kind;  ///< Vertex kind when it is not the command's own ("survey"); else empty.
};

struct MavlinkMission {
  std::vector<MissionItem> items;
  std::optional<RouteHome> home;
  double speed_mps = std::numeric_limits<double>::quiet_NaN();  ///< Until an item changes it.
  bool hovers = false;  ///< Is it known to be a multicopter, which loiters at a point?
  bool is_px4 = false;  ///< Is it known to be for PX4, which takes a height of 0 as it is written?
};

/// Follows the items as an autopilot would (MAVLink common.xml, the mission protocol) and appends vertices, legs, items
/// and notes to `route`, whose name and home-less rest the reader has filled in:
///   - waypoints, loiters, splines, takeoffs and landings become vertices; lat = lon = 0 means "where the aircraft is";
///   - a spline is ArduCopter's curve as chords, a loiter with a radius one circle of chords (mission_curve.h) that is
///     entered and left at its point nearest to where the aircraft comes from; a multicopter loiters at the point
///     unless turns are asked for;
///   - frames 0/5 are above sea level, 3/6 relative to home, 10/11 above terrain; others are refused;
///   - a waypoint's height of 0 keeps the height before, as ArduPilot flies, unless the mission is for PX4; "continue
///   and
///     change altitude" sets the height that is kept, and its climb is on the way to the next position; both are noted;
///   - a takeoff away from home starts with a leg from home, flown at the takeoff's height;
///   - return to launch is a leg to home at the height of the vertex before;
///   - jumps are followed, each distinct leg stands once, items never reached are said.
/// Throws DataError naming the item: a position that is no position, a local frame, a relative height without home's
/// height, a jump to nowhere.
void append_mission(Route& route, const MavlinkMission& mission, const RouteOptions& options);

/// "waypoint", "takeoff", … or "command 4711".
std::string mission_command_name(int command);

}  // namespace pilotage
