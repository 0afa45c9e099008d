#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

enum class ShapeKind { kPoint, kLine, kPolygon };

/// A point, a line or a polygon of a file of vectors, in WGS 84, with what the file says of it. Edges are straight in
/// longitude and latitude.
struct GeodeticShape {
  ShapeKind kind = ShapeKind::kPoint;
  /// Of a point: it alone. Of a line: its vertices, two at least. Of a polygon: outline, then holes, three corners each
  /// at least, the first not repeated. Longitudes within [-360, 360].
  std::vector<std::vector<GeodeticPoint>> rings;
  std::map<std::string, std::string> properties;  ///< What is not null; of OpenStreetMap all tags.
  std::string name;                               ///< For messages: "roofs.geojson: layer "roofs", feature 12".
};

/// The shapes of a GeoJSON, KML, KMZ, GeoPackage or OpenStreetMap file (.osm, .osm.pbf), told apart by content, in the
/// order of the file, whatever they are nested in; curves become chains of edges. Any CRS that PROJ knows is brought to
/// WGS 84. Throws DataError naming the file when it cannot be read, is none of these, is larger than read_route()
/// allows, or has a corner that is no place.
std::vector<GeodeticShape> read_shapes(const std::filesystem::path& path);

}  // namespace pilotage
