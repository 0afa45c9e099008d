#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "pilotage/mission/mission.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A vertex of the route as pilots list waypoints.
struct Waypoint {
  int number = 0;    ///< From 1.
  int item = -1;     ///< Number by which QGroundControl shows its item; -1 where the file has none.
  std::string kind;  ///< RouteVertex::kind.
  GeodeticPoint point;
  double amsl_m = std::numeric_limits<double>::quiet_NaN();  ///< NaN where not known, like the rest.
  double agl_m = std::numeric_limits<double>::quiet_NaN();
  double speed_mps = std::numeric_limits<double>::quiet_NaN();   ///< RouteVertex::speed_mps.
  double distance_m = std::numeric_limits<double>::quiet_NaN();  ///< Along the route, where it is first reached.
  double time_s = std::numeric_limits<double>::quiet_NaN();      ///< Since the start: length over speed.
};

/// Most waypoints that the page and the KML of the route list: tracks have a point every second.
inline constexpr std::size_t kMostWaypointsListed = 500;

/// Whether the route's items have the numbers that QGroundControl shows: those of mission files, which have commands.
bool has_item_numbers(const Route& route);

/// The waypoints of a flight, in the order of the route's vertices. Of the many points of one item (a survey, a circle)
/// the first, or for a spline the one at its end, is its waypoint. A height that the route does not tell is that of
/// the flight's sample there: above sea level and above ground, where an elevation model tells one from the other.
std::vector<Waypoint> waypoints(const Flight& flight);

/// Rows of the page's table, at most kMostWaypointsListed; a last row says how many were left out.
std::string waypoints_html(const std::vector<Waypoint>& all);

}  // namespace pilotage

#pragma GCC visibility pop
