#pragma once

#include <string>
#include <string_view>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// Does the first row of a table name its heights as UgCS does: AltitudeAMSL or AltitudeAGL?
bool is_ugcs_table(std::string_view text);

/// Waypoints as UgCS (SPH Engineering) imports and exports them in CSV, one a row in the order of flight, columns by
/// their names in any order:
///   - Latitude, Longitude (degrees), and AltitudeAMSL (above mean sea level) or AltitudeAGL (above the ground),
///   metres:
///     needed. Where a row has both, it is the one above sea level, since that is what an aircraft is sent;
///   - Speed: m/s, of the way to the waypoint; a blank cell says nothing.
/// Other columns (WP, UavYaw, WaitTime, Picture, CameraTilt, …) are not part of the path.
/// Throws DataError naming the columns that are missing, else the line and column.
Route parse_ugcs_csv(const std::string& name, std::string_view text, const RouteOptions& options);

}  // namespace pilotage
