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

/// The polygons among the shapes of a file of vectors (ogr_shapes.h). Throws as read_shapes(), and DataError naming the
/// file when it holds no polygon, one that is none (GeodeticShape::problem), or more corners than a route may have.
std::vector<GeodeticArea> read_areas(const std::filesystem::path& path);

}  // namespace pilotage
