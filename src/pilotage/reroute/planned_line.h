#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/reroute/no_fly_zones.h"
#include "pilotage/reroute/reroute_options.h"
#include "pilotage/route/route.h"

namespace pilotage {

/// The planned line as a QGroundControl plan that can be edited.
struct PlannedLine {
  std::string name;
  nlohmann::ordered_json json;
  Route route;             ///< Of the JSON: its vertices name the items.
  std::vector<bool> kept;  ///< Of each leg.
};

/// Legs [first, last] that may be flown otherwise.
struct MovableRun {
  std::size_t first = 0;
  std::size_t last = 0;
};

/// A plan of the two points of options.from and options.to, flown straight. Throws UsageError when one is no place or
/// height and speed are missing; DataError when they are one place.
nlohmann::ordered_json plan_of_points(const LineOptions& line, const RouteOptions& options);

/// The options of a mission whose route is a plan: without what is for vector files only.
TileOptions options_for_plan(TileOptions options, const std::filesystem::path& plan);

/// `route`, read from options.route, as a plan: its own, or one made of it; items that such a plan cannot hold are told
/// in `notes`. Throws UsageError for legs to keep that are none, or all; DataError for a route that is not one line,
/// and for legs that may move and lead back to where they begin, whose cheapest line would leave the mission out.
PlannedLine read_planned_line(const TileOptions& options, const LineOptions& line, const Route& route,
                              std::vector<std::string>& notes);

/// Runs of legs that are not kept, each as long as it can be, or with `keep_waypoints` of one leg.
std::vector<MovableRun> movable_runs(const std::vector<bool>& kept, bool keep_waypoints);

/// The plan's geofence and the files of `options.avoid`. Throws as their readers.
NoFlyZones read_zones(const PlannedLine& planned, const LineOptions& options);

}  // namespace pilotage
