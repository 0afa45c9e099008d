#pragma once

#include <filesystem>
#include <map>
#include <memory>
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
  /// What is not null, dates as "YYYY-MM-DD"; of OpenStreetMap all tags. Shared by the parts of a feature; never null.
  std::shared_ptr<const std::map<std::string, std::string>> properties;
  std::string problem;  ///< Why it is no such shape, as a clause; "" when it is one. Who wants it refuses it then.
  std::string name;     ///< For messages: "roofs.geojson: layer "roofs", feature 12".
};

/// The shapes of a GeoJSON, KML, KMZ, GeoPackage or OpenStreetMap file (.osm, .osm.pbf), told apart by content, in the
/// order of the file, whatever they are nested in; curves become chains of edges. Any CRS that PROJ knows is brought to
/// WGS 84. Throws DataError naming the file when it cannot be read, is none of these, or is larger than 64 MiB.
std::vector<GeodeticShape> read_shapes(const std::filesystem::path& path);

}  // namespace pilotage
