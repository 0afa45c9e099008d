#include "pilotage/route/ogr_shapes.h"

#include <cmath>
#include <memory>
#include <string_view>

#include <cpl_string.h>
#include <ogrsf_frmts.h>

#include "pilotage/base/error.h"
#include "pilotage/base/read_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/route/ogr_file.h"
#include "pilotage/route/ogr_kmz.h"
#include "pilotage/route/read_route.h"

namespace pilotage {
namespace {

constexpr int kMostNesting = 32;
/// A PBF begins with the length of its first header in four bytes, and in that stands what kind of block follows.
constexpr std::string_view kPbfMark = "OSMHeader";
constexpr std::size_t kPbfMarkWithin = 32;

OgrFormat shape_format(const std::string& name, std::string_view bytes) {
  if (bytes.starts_with(std::string_view("SQLite format 3\0", 16))) return OgrFormat::kGeoPackage;
  if (bytes.starts_with("PK\x03\x04")) return OgrFormat::kKmz;
  if (bytes.substr(0, kPbfMarkWithin).find(kPbfMark) != std::string_view::npos) return OgrFormat::kOsmPbf;
  const std::string_view text = without_byte_order_mark(bytes);
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '{') return OgrFormat::kGeoJson;
  if (first != std::string_view::npos && text[first] == '<') {
    return text.substr(0, 1024).find("<osm") != std::string_view::npos ? OgrFormat::kOsmXml : OgrFormat::kKml;
  }
  throw DataError(name + ": is no file of shapes that is known here: GeoJSON, KML, KMZ, GeoPackage or OpenStreetMap");
}

/// Vertices of one shape as the file has them.
struct RawShape {
  ShapeKind kind = ShapeKind::kPoint;
  std::vector<std::vector<LinePoint>> rings;
};

std::vector<LinePoint> vertices_of(const OGRSimpleCurve& curve) {
  std::vector<LinePoint> points;
  for (int i = 0; i < curve.getNumPoints(); ++i) points.push_back({curve.getX(i), curve.getY(i)});
  return points;
}

void collect_shapes(const OGRGeometry& geometry, std::vector<RawShape>& shapes, int depth = 0) {
  if (depth > kMostNesting || geometry.IsEmpty() != 0) return;
  if (geometry.hasCurveGeometry() != 0) {
    const std::unique_ptr<OGRGeometry> linear(geometry.getLinearGeometry());
    if (linear) collect_shapes(*linear, shapes, depth + 1);
    return;
  }
  const auto type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon) {
    RawShape& shape = shapes.emplace_back();
    shape.kind = ShapeKind::kPolygon;
    for (const OGRLinearRing* ring : *geometry.toPolygon()) shape.rings.push_back(vertices_of(*ring));
  } else if (type == wkbLineString) {
    shapes.push_back({ShapeKind::kLine, {vertices_of(*geometry.toLineString())}});
  } else if (type == wkbPoint) {
    const OGRPoint* point = geometry.toPoint();
    shapes.push_back({ShapeKind::kPoint, {{{point->getX(), point->getY()}}}});
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection) != 0) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) collect_shapes(*part, shapes, depth + 1);
  }
}

/// Fills a ring of a shape, or says what is wrong with it.
std::string fill_ring(ShapeKind kind, const std::vector<LinePoint>& points, std::vector<GeodeticPoint>& ring) {
  static constexpr const char* kKinds[] = {"point", "line", "polygon"};
  for (const LinePoint& point : points) {
    if (!(std::abs(point.x) <= 360 && std::abs(point.y) <= 90)) {
      return "the corner " + format_number(point.x) + ", " + format_number(point.y) + " of a " +
             kKinds[static_cast<std::size_t>(kind)] + " is no longitude and latitude";
    }
    ring.push_back({point.x, point.y});
  }
  if (kind == ShapeKind::kLine && ring.size() < 2) return "a line has fewer than two vertices";
  if (kind != ShapeKind::kPolygon) return "";
  const bool closed =
      ring.size() > 1 && ring.front().lon_deg == ring.back().lon_deg && ring.front().lat_deg == ring.back().lat_deg;
  if (closed) ring.pop_back();
  return ring.size() < 3 ? "a ring of a polygon has fewer than three corners" : "";
}

/// Tags of OpenStreetMap that have no field of their own stand in one: "key"=>"value","key"=>"value".
void split_other_tags(std::string_view text, std::map<std::string, std::string>& properties) {
  std::vector<std::string> quoted;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '"') continue;
    std::string& part = quoted.emplace_back();
    for (++i; i < text.size() && text[i] != '"'; ++i) {
      if (text[i] == '\\' && i + 1 < text.size()) ++i;
      part += text[i];
    }
  }
  for (std::size_t i = 0; i + 1 < quoted.size(); i += 2) properties.try_emplace(quoted[i], quoted[i + 1]);
}

std::map<std::string, std::string> properties_of(const OGRFeature& feature) {
  std::map<std::string, std::string> properties;
  for (int i = 0; i < feature.GetFieldCount(); ++i) {
    if (!feature.IsFieldSetAndNotNull(i)) continue;
    const std::string key = feature.GetFieldDefnRef(i)->GetNameRef();
    const OGRFieldType type = feature.GetFieldDefnRef(i)->GetType();
    if (type == OFTDate || type == OFTDateTime) {
      int year = 0;
      int month = 0;
      int day = 0;
      int hour = 0;
      int minute = 0;
      int second = 0;
      int zone = 0;
      feature.GetFieldAsDateTime(i, &year, &month, &day, &hour, &minute, &second, &zone);
      const auto two = [](int number) { return (number < 10 ? "-0" : "-") + std::to_string(number); };
      properties[key] = std::to_string(year) + two(month) + two(day);
    } else if (key == "other_tags") {
      split_other_tags(feature.GetFieldAsString(i), properties);
    } else {
      properties[key] = feature.GetFieldAsString(i);
    }
  }
  return properties;
}

std::vector<GeodeticShape> shapes_of_file(const std::string& name, const OgrFile& file) {
  std::vector<GeodeticShape> shapes;
  for (OGRLayer* layer : file.dataset().GetLayers()) {
    const std::string layer_name = name + ": layer \"" + layer->GetName() + "\"";
    const ToWgs84 to_wgs84(*layer, layer_name);
    for (const auto& feature : *layer) {
      const OGRGeometry* geometry = feature->GetGeometryRef();
      if (geometry == nullptr) continue;
      const std::string feature_name = layer_name + ", feature " + std::to_string(feature->GetFID());
      std::vector<RawShape> raw;
      collect_shapes(*geometry, raw);
      const auto properties = std::make_shared<const std::map<std::string, std::string>>(properties_of(*feature));
      for (RawShape& one : raw) {
        GeodeticShape& shape = shapes.emplace_back();
        shape.kind = one.kind;
        shape.properties = properties;
        shape.name = feature_name;
        for (std::vector<LinePoint>& ring : one.rings) {
          to_wgs84.apply(ring);
          const std::string problem = fill_ring(one.kind, ring, shape.rings.emplace_back());
          if (shape.problem.empty()) shape.problem = problem;
        }
      }
    }
  }
  file.check_whole();
  return shapes;
}

}  // namespace

std::vector<GeodeticShape> read_shapes(const std::filesystem::path& path) {
  const std::string bytes = read_file(path, kMaxRouteBytes);
  const std::string name = name_as_utf8(path.string());
  const OgrFormat format = shape_format(name, bytes);
  if (format != OgrFormat::kKmz) return shapes_of_file(name, OgrFile(name, bytes, format));
  const std::vector<KmzDocument> documents = unpack_kmz(name, bytes);
  const std::string& text = main_document(name, documents).text;
  return shapes_of_file(name, OgrFile(name, text, format));
}

}  // namespace pilotage
