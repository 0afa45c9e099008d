#include "pilotage/route/ogr_areas.h"

#include <cmath>
#include <memory>
#include <string>
#include <string_view>

#include <ogrsf_frmts.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/base/utf8.h"
#include "pilotage/route/ogr_file.h"
#include "pilotage/route/ogr_kmz.h"
#include "pilotage/route/read_route.h"
#include "pilotage/route/route_size.h"

namespace pilotage {
namespace {

constexpr int kMostNesting = 32;

OgrFormat area_format(const std::string& name, std::string_view bytes) {
  if (bytes.starts_with(std::string_view("SQLite format 3\0", 16))) return OgrFormat::kGeoPackage;
  if (bytes.starts_with("PK\x03\x04")) return OgrFormat::kKmz;
  const std::string_view text = without_byte_order_mark(bytes);
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '{') {
    check_json_route_size(name, text);
    return OgrFormat::kGeoJson;
  }
  if (first != std::string_view::npos && text[first] == '<') {
    check_kml_size(name, text);
    return OgrFormat::kKml;
  }
  throw DataError(name + ": is no file of polygons that is known here: GeoJSON, KML, KMZ or GeoPackage");
}

struct AreaParts {
  std::vector<std::vector<std::vector<LinePoint>>> polygons;
  int others = 0;
};

void collect_polygons(const OGRGeometry& geometry, AreaParts& parts, int depth = 0) {
  if (depth > kMostNesting || geometry.IsEmpty() != 0) return;
  if (geometry.hasCurveGeometry() != 0) {
    const std::unique_ptr<OGRGeometry> linear(geometry.getLinearGeometry());
    if (linear) collect_polygons(*linear, parts, depth + 1);
    return;
  }
  const auto type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon) {
    auto& rings = parts.polygons.emplace_back();
    for (const OGRLinearRing* ring : *geometry.toPolygon()) {
      auto& points = rings.emplace_back();
      for (int i = 0; i < ring->getNumPoints(); ++i) points.push_back({ring->getX(i), ring->getY(i)});
    }
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection) != 0) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) collect_polygons(*part, parts, depth + 1);
  } else {
    ++parts.others;
  }
}

std::vector<GeodeticPoint> ring_of(const std::string& name, const std::vector<LinePoint>& points) {
  std::vector<GeodeticPoint> ring;
  for (const LinePoint& point : points) {
    if (!(std::abs(point.x) <= 360 && std::abs(point.y) <= 90)) {
      throw DataError(name + ": the corner " + format_number(point.x) + ", " + format_number(point.y) +
                      " of a polygon is no longitude and latitude");
    }
    ring.push_back({point.x, point.y});
  }
  const bool closed =
      ring.size() > 1 && ring.front().lon_deg == ring.back().lon_deg && ring.front().lat_deg == ring.back().lat_deg;
  if (closed) ring.pop_back();
  if (ring.size() < 3) throw DataError(name + ": a ring of a polygon has fewer than three corners");
  return ring;
}

std::vector<GeodeticArea> areas_of(const std::string& name, const OgrFile& file) {
  std::vector<GeodeticArea> areas;
  std::size_t corners = 0;
  int others = 0;
  for (OGRLayer* layer : file.dataset().GetLayers()) {
    const ToWgs84 to_wgs84(*layer, name + ": layer \"" + layer->GetName() + "\"");
    for (const auto& feature : *layer) {
      const OGRGeometry* geometry = feature->GetGeometryRef();
      if (geometry == nullptr) continue;
      AreaParts parts;
      collect_polygons(*geometry, parts);
      others += parts.others;
      for (auto& polygon : parts.polygons) {
        GeodeticArea& area = areas.emplace_back();
        for (std::vector<LinePoint>& ring : polygon) {
          check_position_count(name, corners += ring.size());
          to_wgs84.apply(ring);
          area.rings.push_back(ring_of(name, ring));
        }
      }
    }
  }
  file.check_whole();
  if (areas.empty()) {
    throw DataError(name + ": holds no polygon" +
                    (others > 0 ? ", but " + std::to_string(others) + " other shapes, as lines or points" : ""));
  }
  return areas;
}

std::vector<GeodeticArea> parse_areas(const std::string& name, std::string_view bytes) {
  const OgrFormat format = area_format(name, bytes);
  if (format != OgrFormat::kKmz) return areas_of(name, OgrFile(name, bytes, format));
  const std::vector<KmzDocument> documents = unpack_kmz(name, bytes);
  const std::string& text = main_document(name, documents).text;
  check_kml_size(name, text);
  return areas_of(name, OgrFile(name, text, format));
}

}  // namespace

std::vector<GeodeticArea> read_areas(const std::filesystem::path& path) {
  const std::string bytes = read_file(path, kMaxRouteBytes);
  return parse_areas(name_as_utf8(path.string()), bytes);
}

}  // namespace pilotage
