#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// Is it a route that UgCS exports as JSON: an object "route" with "segments"?
bool is_ugcs_route(const nlohmann::ordered_json& json);

/// A route of UgCS (SPH Engineering), as its desktop program exports it in JSON. Of each of route.segments, which must
/// be of type Waypoint:
///   - point.latitude, point.longitude: radians; point.altitude with point.altitudeType AGL (above the ground) or AMSL
///     (above mean sea level);
///   - parameters.speed: m/s, of the way to the waypoint; parameters.cornerRadius: how early a turn begins, unless
///     wpTurnType is STOP_AND_TURN or STRAIGHT.
/// Throws DataError: for segments of another type (surveys, circles) it says to export the route as KML, else it names
/// the segment and the key. Positions in degrees, which are no radians, are refused.
Route parse_ugcs_json(const std::string& name, const nlohmann::ordered_json& json, const RouteOptions& options);

}  // namespace pilotage
