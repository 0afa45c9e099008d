#pragma once

#include <string>
#include <string_view>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// Does the text begin like a document of a DJI mission (the namespace www.dji.com/wpmz in its first 4 KiB)?
bool is_dji_wpml(std::string_view text);

/// A DJI mission (WPML, "DJI Cloud API", API reference, DJI WPML): `waylines` is the text of wpmz/waylines.wpml, the
/// path as it is executed; `mission_template` that of wpmz/template.kml, from which DJI's programs made it. One of them
/// may be empty; the path comes from `waylines` where that is there.
///   - Waypoints are flown in the order of their index; several waylines (folders) one after another in the order of
///     their waylineId, or the one that RouteOptions::feature numbers.
///   - Heights: executeHeightMode WGS84 (brought to sea level), relativeToStartPoint (the take-off's height is that of
///     the options, else of the template's takeOffRefPoint), realTimeFollowSurface (above ground); heightMode EGM96 and
///     aboveGroundLevel of templates. Where the take-off's height is not known the vertices have none, and a note says
///     so.
///   - Speeds: waypointSpeed of the waypoint before, else autoFlightSpeed; between waylines globalTransitionalSpeed.
///   - The camera of payloadEnumValue, where the table of products has it (camera_products.h).
/// Legs are straight; how far turns cut corners stands in a note. Throws DataError naming what is missing or out of
/// range: a template that holds an area and no path, an index that stands twice, an unknown height mode.
Route parse_dji_wpml(const std::string& name, const std::string& format, std::string_view waylines,
                     std::string_view mission_template, const RouteOptions& options);

}  // namespace pilotage
