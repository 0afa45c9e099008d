#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// A QGroundControl plan (https://docs.qgroundcontrol.com/master/en/qgc-dev-user-guide/file_formats/plan.html):
/// fileType "Plan" of version 1 with a mission of version 2. Positions come from `params` and `frame` of each item,
/// never from AltitudeMode.
///   - Simple items as append_mission says.
///   - Survey (version 4 or 5) and CorridorScan (version 2): the mission items they hold in
///   TransectStyleComplexItem.Items; their
///     CameraCalc becomes Route::camera (the first that has figures).
///   - fwLandingPattern and vtolLandingPattern: their approach point, then the landing point.
///   - StructureScan: left out and said, because its path is not in the file and its camera looks sideways.
///   - Geofence and rally points are not flown to.
/// Throws DataError naming the item for anything else.
Route parse_qgc_plan(const std::string& name, const nlohmann::ordered_json& json, const RouteOptions& options);

/// The number (RouteItem::index) of each element of the plan's list of items, in its order; of a survey that of its
/// first command. Throws as parse_qgc_plan, as far as the items themselves are concerned.
std::vector<int> qgc_item_numbers(const std::string& name, const nlohmann::ordered_json& json);

}  // namespace pilotage
