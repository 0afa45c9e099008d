#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "pilotage/raster/gdal_crs.h"

namespace pilotage {

enum class VectorType { kBoolean, kInteger, kReal, kText };

struct VectorColumn {
  std::string name;  ///< As programs know it: "p_correct_fix".
  VectorType type = VectorType::kReal;
  std::string title;  ///< For people, with the unit; QGIS shows it as the column's alias. May be empty.
};

/// std::monostate is NULL. The type is that of the column.
using VectorValue = std::variant<std::monostate, bool, std::int64_t, double, std::string>;

enum class VectorShape { kNone, kPoint, kLine, kPolygon };

/// Colours are "#rrggbbaa".
struct VectorStyle {
  std::string line_color = "#000000ff";
  double line_width_px = 1;
  std::string fill_color;  ///< Of a polygon; "" for none.
};

struct VectorFeature {
  /// Of a point: it alone. Of a line: at least two points. Of a polygon: its corners, the first not repeated. In the
  /// layer's CRS; of a geographic one in degrees, longitude first, neighbours joined the short way round.
  std::vector<Eigen::Vector2d> points;
  std::vector<std::vector<Eigen::Vector2d>> holes;  ///< Of a polygon, as `points`.
  std::vector<VectorValue> values;                  ///< One per column.
  std::string title;                                ///< KML: the placemark's name.
  std::string note;                                 ///< KML: its description.
  VectorStyle style;                                ///< KML.
};

struct VectorLayer {
  std::string name;         ///< For programs: "legs".
  std::string title;        ///< For people.
  std::string description;  ///< One sentence.
  VectorShape shape = VectorShape::kNone;
  Crs crs;  ///< Of the points; not asked for kNone.
  std::vector<VectorColumn> columns;
  std::vector<VectorFeature> features;
  std::string qml;      ///< GeoPackage: the layer's default style in QGIS; "" for none.
  bool visible = true;  ///< KML: whether it is shown on opening.
};

/// The outline of polygons that touch along edges or overlap, with its holes; of the result only `points` and `holes`
/// are set. Throws UsageError when there is none or they do not make one piece.
VectorFeature join_polygons(const std::vector<std::vector<Eigen::Vector2d>>& polygons);

/// GeoJSON by RFC 7946: WGS 84 with seven decimals, shapes cut at the antimeridian, outer rings counter-clockwise. What
/// stands in the file is one layer. The same input gives the same bytes; the file appears complete or not at all.
/// Throws UsageError when a feature does not fit its layer, DataError when the file exists and `overwrite` is false, or
/// cannot be written.
void write_geojson(const std::filesystem::path& path, const VectorLayer& layer, bool overwrite);

/// GeoPackage 1.3 with all layers in their own CRS, lines in degrees cut at the antimeridian, an R-tree for each, and
/// the table layer_styles from which QGIS takes a layer's style when it opens it; `timestamp` ("2026-01-01T00:00:00Z")
/// is every date in the file. Otherwise as write_geojson.
void write_geopackage(const std::filesystem::path& path, const std::vector<VectorLayer>& layers,
                      const std::string& timestamp, bool overwrite);

/// The shape of one feature as a geometry of RFC 7946 (WGS 84, seven decimals, cut at the antimeridian), and the box
/// around it, which reaches over the antimeridian where west_deg > east_deg. Throws as write_geojson.
struct DegreeShape {
  std::string geojson;
  double west_deg = 0;
  double south_deg = 0;
  double east_deg = 0;
  double north_deg = 0;
};
DegreeShape degree_shape(const VectorLayer& layer, const VectorFeature& feature);

/// KML 2.2: a document with one folder for each layer that has a shape, styles inside, points, lines and polygons on
/// the ground, all columns as extended data with their titles. GDAL's own writer takes minutes for some thousand
/// polygons, so the text is put together here. Throws as write_geojson.
std::string kml_document(const std::string& title, const std::vector<VectorLayer>& layers);

}  // namespace pilotage
