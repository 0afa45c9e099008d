#pragma once

#include <string>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// What the readers share when they put a Route together.

/// Positions nearer than this are one place.
inline constexpr double kSamePlace_m = 0.01;

/// A checked position: throws DataError starting with `where` when lat is outside [-90, 90], lon outside
/// [-max_abs_lon_deg, max_abs_lon_deg] or one is not finite. The longitude comes back in [-180, 180].
GeodeticPoint checked_point(double lat_deg, double lon_deg, const std::string& where, double max_abs_lon_deg = 180);

/// Throws DataError when a height is not within ±100 km; NaN (not known) passes.
double checked_height_m(double height_m, const std::string& where);

/// Appends the vertex and returns its index; the last vertex is used again when it has the same place and heights.
/// Throws DataError at kMaxRouteVertices.
int append_vertex(Route& route, const RouteVertex& vertex);

/// Appends the leg unless it has no length. Says whether it did.
bool append_leg(Route& route, int from, int to);

/// What makes a vertex no vertex of its own (append_vertex), for Route::items.
inline constexpr const char* kSamePlaceText = "no vertex: same place and height as the vertex before";

/// Appends the next waypoint of a file that is a list of them: the vertex, the leg to it, and its item, the next number
/// from 1.
void append_waypoint(Route& route, RouteVertex vertex);

/// Adds a sentence unless it stands there already.
void add_note(Route& route, const std::string& note);

/// The note on heights above the take-off: as the options say how high it lies, else as `route.home` does, which is
/// then called `home_is` ("the template's reference point"), else that this is missing. None where the options give a
/// constant height above ground.
void add_takeoff_note(Route& route, const RouteOptions& options, const std::string& home_is);

/// Options that hold for every format: constant height above ground, constant speed. Call when the vertices are
/// complete.
void apply_options(Route& route, const RouteOptions& options);

/// Throws DataError when the route has no position, or nothing to fly between.
void require_legs(const Route& route);

}  // namespace pilotage
