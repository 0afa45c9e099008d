#pragma once

#include <filesystem>
#include <vector>

#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

/// A polygon on the ground; its edges are straight in longitude and latitude and run as their numbers say, so one that
/// reaches over the antimeridian is cut there, or has longitudes beyond 180.
struct GeodeticArea {
  /// Outline, then holes: at least three corners each, the first not repeated; longitudes within [-360, 360].
  std::vector<std::vector<GeodeticPoint>> rings;
};

/// The polygons of a GeoJSON, KML, KMZ or GeoPackage file, told apart by content, in the order of the file, whatever
/// they are nested in; curves become chains of edges. Any CRS that PROJ knows is brought to WGS 84. Throws DataError
/// naming the file when it cannot be read, is none of these, is larger than read_route() allows, holds no polygon, or
/// has a corner that is no place.
std::vector<GeodeticArea> read_areas(const std::filesystem::path& path);

}  // namespace pilotage
