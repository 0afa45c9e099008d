#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

enum class OgrFormat { kKml, kKmz, kGpx, kGeoJson, kGeoPackage, kOsmXml, kOsmPbf };

/// A route out of a KML, KMZ (the bytes of its document), GPX, GeoJSON or GeoPackage file, read through OGR from
/// memory.
///   - One line is the route; its parts are joined in order. Where a file has several, RouteOptions::layer and
///   ::feature choose;
///     without them DataError lists what there is. A file without lines gives its points, in the order of the file.
///   - GPX: routes come before tracks before waypoints; a point without <ele> has no height (OGR's own 2.5-D lines
///   would
///     put 0 there).
///   - KML: a line is above sea level or ground as its altitudeMode says; clampToGround, which is the default, tells no
///   height.
///   - GeoJSON, GeoPackage: heights are used only when RouteOptions::height_reference says what they are above.
///   - Any CRS that PROJ knows is brought to WGS 84; longitudes up to ±360 are wrapped.
/// Throws DataError; see read_route.h.
Route parse_ogr_route(const std::string& name, std::string_view bytes, OgrFormat format, const RouteOptions& options);

/// Brings amsl_m of the vertices from heights above the WGS 84 ellipsoid to heights above the EGM96 geoid; NaN stays.
/// Throws DataError when PROJ has no egm96_15.gtx (Debian package proj-data).
void bring_to_sea_level(const std::string& name, std::vector<RouteVertex>& vertices);

}  // namespace pilotage
