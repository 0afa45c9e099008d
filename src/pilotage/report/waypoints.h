#pragma once

#include <limits>
#include <string>
#include <vector>

#include "pilotage/mission/mission.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A vertex of the route as pilots list waypoints.
struct Waypoint {
  int number = 0;    ///< From 1, in the order of the route's vertices.
  int item = -1;     ///< Number by which QGroundControl shows its item; -1 where the file has none.
  std::string kind;  ///< RouteVertex::kind.
  GeodeticPoint point;
  double amsl_m = std::numeric_limits<double>::quiet_NaN();  ///< NaN where not known, like the rest.
  double agl_m = std::numeric_limits<double>::quiet_NaN();
  double distance_m = std::numeric_limits<double>::quiet_NaN();  ///< Along the route, where it is first reached.
  double time_s = std::numeric_limits<double>::quiet_NaN();      ///< Since the start: length over speed.
};

/// The waypoints of a flight, in the order of the route's vertices. A height that the route does not tell is that of
/// the flight's sample there: above sea level and above ground, where an elevation model tells one from the other.
std::vector<Waypoint> waypoints(const Flight& flight);

/// Rows of the page's table, at most 500; a last row says how many were left out.
std::string waypoints_html(const std::vector<Waypoint>& all);

}  // namespace pilotage

#pragma GCC visibility pop
