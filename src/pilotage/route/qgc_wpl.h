#pragma once

#include <string>
#include <string_view>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// Does the text start with the words "QGC WPL" (after a byte order mark)?
bool is_qgc_wpl(std::string_view text);

/// A "QGC WPL 110" file (.waypoints, .txt; https://mavlink.io/en/file_formats/): one item a line, twelve fields
/// separated by blanks: number, current, frame, command, param1 … param4, latitude, longitude, altitude, autocontinue.
/// Row 0 is home; a row 0 whose command is not a waypoint comes from a program that writes no home row: then it is
/// flown as an item and its place stands in for home, without a height. Empty lines and lines starting with # are
/// skipped. Throws DataError with the line's number.
Route parse_qgc_wpl(const std::string& name, std::string_view text, const RouteOptions& options);

}  // namespace pilotage
