#pragma once

#include <string>
#include <string_view>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// Is the text a table: a first line of text with commas, semicolons or tabs in it?
bool is_table(std::string_view text);

/// A mission of Litchi (CSV export of its Mission Hub; columns: litchiutilities.com/docs/litchiCsv.php), one waypoint a
/// row, columns by their names in any order:
///   - latitude, longitude, altitude(m) or altitude(ft): needed;
///   - altitudemode 0 (above the take-off, the default) or 1 (above the ground);
///   - speed(m/s) or speed(mph), to the next waypoint; 0 is the mission's cruising speed, which the file does not hold;
///   - curvesize(m) or curvesize(ft): how early the turn begins; the legs stay straight and a note says by how much the
///     aircraft leaves them;
///   - gimbalpitchangle: a note where it does not look straight down.
/// Throws DataError: for a table of other columns it names those that are needed, else the line and column.
Route parse_litchi_csv(const std::string& name, std::string_view text, const RouteOptions& options);

}  // namespace pilotage
