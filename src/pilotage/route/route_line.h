#pragma once

#include <limits>
#include <string>
#include <vector>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// Lines of vector files on their way to a Route.

/// A point of a line in longitude and latitude (or, before it is brought to WGS 84, in its own CRS).
struct LinePoint {
  double x = 0;  ///< Easting or longitude.
  double y = 0;
  double z_m = std::numeric_limits<double>::quiet_NaN();
  double time_s = std::numeric_limits<double>::quiet_NaN();  ///< When the aircraft was there, since any moment.
};

/// A line (or the points of a layer) that could be the route.
struct Line {
  std::string layer;
  std::string name;
  std::string what;  ///< "line", "route", "track", "points"
  std::vector<std::vector<LinePoint>> parts;
  HeightReference heights = HeightReference::kAuto;  ///< As the file says; kAuto when it does not.

  std::size_t point_count() const {
    std::size_t count = 0;
    for (const auto& part : parts) count += part.size();
    return count;
  }
};

/// The line that RouteOptions::layer and ::feature mean, or the only one; the others are told in Route::items. Throws
/// DataError that lists what there is.
Line choose_line(Route& route, std::vector<Line> lines, const RouteOptions& options);

/// Appends vertices and legs of the line, parts joined in order. The heights stand in amsl_m, whatever they are above,
/// until resolve_heights. Positions with times give speeds (track_speed.h). Throws DataError for positions that are
/// none.
void append_line(Route& route, const Line& line);

/// Brings the heights of the vertices from where append_line left them to where they belong, as
/// RouteOptions::height_reference or the file says. Throws UsageError when heights above home come without home's
/// height.
void resolve_heights(Route& route, const Line& line, const RouteOptions& options);

}  // namespace pilotage
