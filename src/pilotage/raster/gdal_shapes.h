#pragma once

#include <memory>
#include <string>
#include <vector>

#include <ogr_geometry.h>
#include <ogr_spatialref.h>

#include "pilotage/raster/gdal_vector.h"

// Private to raster/gdal_*.cc: shapes of a VectorLayer as OGR has them.

namespace pilotage {

using GeometryPtr = std::unique_ptr<OGRGeometry>;

OGRSpatialReference layer_reference(const Crs& crs);

/// Outer rings counter-clockwise, holes clockwise, as GeoJSON wants them and the others do not mind. Throws UsageError
/// naming `layer`.
std::unique_ptr<OGRPolygon> polygon_shape(const std::vector<Eigen::Vector2d>& points,
                                          const std::vector<std::vector<Eigen::Vector2d>>& holes,
                                          const std::string& layer);

/// Throws UsageError when a feature has not one value for each column.
void check_values(const VectorLayer& layer, const VectorFeature& feature);

/// The shapes of a layer in its own CRS, or in WGS 84; those in degrees cut at the antimeridian. Empty for kNone.
std::vector<GeometryPtr> shapes_of(const VectorLayer& layer, bool in_wgs84);

}  // namespace pilotage
