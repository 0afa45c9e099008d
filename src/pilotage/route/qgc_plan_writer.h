#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/route/route.h"

namespace pilotage {

/// A waypoint that a plan is to get. Heights as RouteVertex has them: one of the two is there, or none where the route
/// takes its heights from elsewhere (RouteOptions::agl_m).
struct PlanWaypoint {
  GeodeticPoint point;
  double amsl_m = 0;  ///< NaN where only the height above ground is known.
  double agl_m = 0;   ///< NaN where only the height above sea level is known.
  double share = 0;   ///< How far along its stretch it lies, 0 … 1; for heights that are in the file alone.
};

/// A stretch of the route, from one of its vertices to another, and the waypoints that are flown between them instead.
struct MovedStretch {
  int from_vertex = 0;  ///< Index into Route::vertices. Both ends stay.
  int to_vertex = 0;
  std::vector<PlanWaypoint> waypoints;
};

/// A plan, and what became of the items on stretches that were moved.
struct MovedPlan {
  nlohmann::ordered_json json;
  std::vector<std::string> removed;  ///< "item 6 (waypoint)": flown to before, gone now.
  std::vector<std::string> lost;     ///< Of these, those that did more than lead the way, each with what is lost.
  std::vector<std::string> shifted;  ///< Items without a place that now happen at another one.
};

/// The plan `json` (of which `route` was read) with other waypoints on some stretches. All else stays as it is: home,
/// geofence, rally points, items before, between and behind the stretches, keys that nobody here knows. New waypoints
/// are NAV_WAYPOINT in the frame of the item where their stretch begins, or of the one where it ends when it begins at
/// home: relative to home, above sea level, or above the terrain. Items without a place on a stretch stay, at the new
/// waypoint nearest to where they were, in their order. The numbers of items behind a stretch (doJumpId) move with
/// what was added or taken.
///
/// Throws DataError naming the item for a mission with jumps, whose targets would no longer be there, and for vertices
/// that no item stands for.
MovedPlan move_stretches(const std::string& name, const nlohmann::ordered_json& json, const Route& route,
                         const std::vector<MovedStretch>& stretches);

/// A plan of its own (fileType Plan, version 1; mission of version 2) of a route that came from another kind of file:
/// a waypoint for each vertex in the order of flight, above the terrain (frame 10) where the height above ground is
/// what is flown, above sea level (frame 0) else; a change of speed wherever it changes; home where the route has one,
/// else its first vertex. parse_qgc_plan gives the same line, heights and speeds back. Throws DataError for a route
/// whose legs do not follow each other.
nlohmann::ordered_json plan_of_route(const Route& route);

/// Throws DataError unless each leg of the route begins where the one before ends.
void require_one_line(const Route& route);

}  // namespace pilotage
