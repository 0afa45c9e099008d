#include "pilotage/raster/gdal_shapes.h"

#include <cpl_string.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_handle.h"

namespace pilotage {
namespace {

void add_points(OGRSimpleCurve& curve, const std::vector<Eigen::Vector2d>& points, std::size_t least,
                const std::string& layer) {
  if (points.size() < least) {
    throw UsageError("layer " + layer + ": a feature has " + std::to_string(points.size()) + " points, at least " +
                     std::to_string(least) + " are needed");
  }
  for (const Eigen::Vector2d& point : points) {
    if (!point.allFinite()) throw UsageError("layer " + layer + ": a point is not finite");
    curve.addPoint(point.x(), point.y());
  }
}

GeometryPtr shape_of(const VectorLayer& layer, const VectorFeature& feature) {
  if (layer.shape == VectorShape::kPoint) {
    if (feature.points.size() != 1 || !feature.points.front().allFinite()) {
      throw UsageError("layer " + layer.name + ": a feature is not one finite point");
    }
    return std::make_unique<OGRPoint>(feature.points.front().x(), feature.points.front().y());
  }
  if (layer.shape == VectorShape::kPolygon) return polygon_shape(feature.points, feature.holes, layer.name);
  auto line = std::make_unique<OGRLineString>();
  add_points(*line, feature.points, 2, layer.name);
  return line;
}

}  // namespace

OGRSpatialReference layer_reference(const Crs& crs) {
  OGRSpatialReference reference;
  if (reference.SetFromUserInput(crs.wkt().c_str()) != OGRERR_NONE) throw UsageError("the CRS of a layer is not known");
  reference.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return reference;
}

std::unique_ptr<OGRPolygon> polygon_shape(const std::vector<Eigen::Vector2d>& points,
                                          const std::vector<std::vector<Eigen::Vector2d>>& holes,
                                          const std::string& layer) {
  auto polygon = std::make_unique<OGRPolygon>();
  const auto add_ring = [&](const std::vector<Eigen::Vector2d>& corners, bool clockwise) {
    auto ring = std::make_unique<OGRLinearRing>();
    add_points(*ring, corners, 3, layer);
    ring->closeRings();
    if ((ring->isClockwise() != 0) != clockwise) ring->reverseWindingOrder();
    polygon->addRingDirectly(ring.release());
  };
  add_ring(points, false);
  for (const auto& hole : holes) add_ring(hole, true);
  return polygon;
}

void check_values(const VectorLayer& layer, const VectorFeature& feature) {
  if (feature.values.size() == layer.columns.size()) return;
  throw UsageError("layer " + layer.name + ": a feature has " + std::to_string(feature.values.size()) + " values for " +
                   std::to_string(layer.columns.size()) + " columns");
}

std::vector<GeometryPtr> shapes_of(const VectorLayer& layer, bool in_wgs84) {
  std::vector<GeometryPtr> shapes;
  if (layer.shape == VectorShape::kNone) return shapes;
  const GdalErrors errors;
  std::unique_ptr<OGRCoordinateTransformation> transform;
  OGRSpatialReference from = layer_reference(layer.crs);
  OGRSpatialReference to = layer_reference(Crs::wgs84());
  if (in_wgs84 && !layer.crs.same_as(Crs::wgs84())) {
    transform.reset(OGRCreateCoordinateTransformation(&from, &to));
    if (transform == nullptr) errors.throw_data_error("layer " + layer.name + ": no way to WGS 84");
  }
  const CPLStringList options(CSLSetNameValue(nullptr, "WRAPDATELINE", "YES"));
  OGRGeometryFactory::TransformWithOptionsCache cache;
  for (const VectorFeature& feature : layer.features) {
    GeometryPtr shape = shape_of(layer, feature);
    if (transform != nullptr || layer.crs.is_geographic()) {
      shape.reset(OGRGeometryFactory::transformWithOptions(shape.get(), transform.get(),
                                                           const_cast<char**>(options.List()), cache));
      if (shape == nullptr) errors.throw_data_error("layer " + layer.name + ": a shape has no place in WGS 84");
    }
    shapes.push_back(std::move(shape));
  }
  return shapes;
}

}  // namespace pilotage
