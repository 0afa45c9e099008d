#include "pilotage/route/ogr_route.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <vector>

#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/route/ogr_file.h"
#include "pilotage/route/ogr_track.h"
#include "pilotage/route/ogr_written_heights.h"
#include "pilotage/route/read_route.h"
#include "pilotage/route/route_builder.h"
#include "pilotage/route/route_line.h"
#include "pilotage/route/route_size.h"

namespace pilotage {
namespace {

std::string text_field(const OGRFeature& feature, const char* field) {
  const int index = feature.GetFieldIndex(field);
  return index >= 0 && feature.IsFieldSetAndNotNull(index) ? feature.GetFieldAsString(index) : "";
}

std::string feature_name(const OGRFeature& feature) {
  for (const char* field : {"name", "Name", "NAME", "title"}) {
    std::string name = text_field(feature, field);
    if (!name.empty()) return name;
  }
  return "";
}

HeightReference kml_heights(const OGRFeature& feature) {
  const std::string mode = text_field(feature, "altitudeMode");
  if (mode == "absolute") return HeightReference::kAmsl;
  if (mode == "relativeToGround") return HeightReference::kAgl;
  return HeightReference::kAuto;
}

void append_points(const OGRSimpleCurve& curve, std::vector<LinePoint>& points) {
  for (int i = 0; i < curve.getNumPoints(); ++i) {
    LinePoint point{curve.getX(i), curve.getY(i)};
    if (curve.Is3D() != 0) point.z_m = curve.getZ(i);
    points.push_back(point);
  }
}

/// Collects lines and points of a geometry, whatever it is nested in; counts what is neither.
struct GeometryParts {
  std::vector<std::vector<LinePoint>> lines;
  std::vector<LinePoint> points;
  int others = 0;
};

void collect(const OGRGeometry& geometry, GeometryParts& parts, int depth = 0) {
  if (depth > 32 || geometry.IsEmpty() != 0) return;
  const auto type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbLineString) {
    parts.lines.emplace_back();
    append_points(*geometry.toLineString(), parts.lines.back());
  } else if (type == wkbPoint) {
    const OGRPoint& point = *geometry.toPoint();
    parts.points.push_back({point.getX(), point.getY()});
    if (point.Is3D() != 0) parts.points.back().z_m = point.getZ();
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection) != 0 && type != wkbMultiPolygon &&
             type != wkbMultiSurface) {
    for (const OGRGeometry* part : *geometry.toGeometryCollection()) collect(*part, parts, depth + 1);
  } else {
    ++parts.others;
  }
}

/// Lines of a layer, or its points as one line when it has no line.
std::vector<Line> layer_lines(Route& route, OGRLayer& layer, OgrFormat format, WrittenHeights& written) {
  const bool is_kml = format == OgrFormat::kKml || format == OgrFormat::kKmz;
  const ToWgs84 to_wgs84(layer, route.name + ": layer \"" + layer.GetName() + "\"");
  if (layer.GetSpatialRef() == nullptr) {
    add_note(route,
             "Layer \"" + std::string(layer.GetName()) +
                 "\" names no coordinate reference system: its coordinates are taken as longitude and latitude.");
  }
  std::vector<Line> lines;
  Line points{layer.GetName(), layer.GetName(), "points", {{}}};
  std::size_t count = 0;
  for (const auto& feature : layer) {
    const OGRGeometry* geometry = feature->GetGeometryRef();
    if (geometry == nullptr) continue;
    GeometryParts parts;
    collect(*geometry, parts);
    const HeightReference heights = is_kml ? kml_heights(*feature) : HeightReference::kAuto;
    if (!parts.lines.empty()) {
      lines.push_back({layer.GetName(), feature_name(*feature), "line", std::move(parts.lines), heights});
      for (auto& part : lines.back().parts) {
        written.apply(part);
        to_wgs84.apply(part);
      }
      count += lines.back().point_count();
    } else if (!parts.points.empty()) {
      written.apply(parts.points);
      to_wgs84.apply(parts.points);
      const bool first = points.parts[0].empty();
      if (first) points.heights = heights;
      if (points.heights != heights) points.heights = HeightReference::kAuto;
      points.parts[0].insert(points.parts[0].end(), parts.points.begin(), parts.points.end());
      count += parts.points.size();
    } else if (parts.others > 0) {
      route.items.push_back({static_cast<int>(route.items.size()), -1,
                             std::string(geometry->getGeometryName()) + " \"" + feature_name(*feature) + "\"",
                             "left out: neither a line nor a point"});
    }
    check_position_count(route.name, count);
  }
  if (lines.empty() && !points.parts[0].empty()) lines.push_back(std::move(points));
  return lines;
}

std::vector<Line> vector_lines(Route& route, GDALDataset& dataset, OgrFormat format, std::string_view bytes) {
  WrittenHeights written(route.name, bytes, format);
  std::vector<Line> lines;
  std::vector<Line> points;
  for (OGRLayer* layer : dataset.GetLayers()) {
    for (Line& line : layer_lines(route, *layer, format, written)) {
      (line.what == "line" ? lines : points).push_back(line);
    }
  }
  return lines.empty() ? points : lines;
}

/// GPX points one by one: only there does OGR say which of them have an elevation.
std::vector<Line> gpx_point_lines(const std::string& name, OGRLayer& named, OGRLayer& point_layer,
                                  const char* fid_field, const char* segment_field, const std::string& what) {
  std::map<GIntBig, std::string> names;
  for (const auto& feature : named) names[feature->GetFID()] = feature_name(*feature);
  std::map<GIntBig, Line> lines;
  int last_segment = -1;
  GIntBig last_line = -1;
  std::size_t count = 0;
  for (const auto& feature : point_layer) {
    const OGRGeometry* geometry = feature->GetGeometryRef();
    if (geometry == nullptr || wkbFlatten(geometry->getGeometryType()) != wkbPoint) continue;
    const GIntBig id = feature->GetFieldAsInteger64(fid_field);
    const int segment = segment_field == nullptr ? 0 : feature->GetFieldAsInteger(segment_field);
    Line& line =
        lines.try_emplace(id, Line{named.GetName(), names[id], what, {}, HeightReference::kAmsl}).first->second;
    if (id != last_line || segment != last_segment) line.parts.emplace_back();
    last_line = id;
    last_segment = segment;
    LinePoint point{geometry->toPoint()->getX(), geometry->toPoint()->getY()};
    const int elevation = feature->GetFieldIndex("ele");
    if (elevation >= 0 && feature->IsFieldSetAndNotNull(elevation)) point.z_m = feature->GetFieldAsDouble(elevation);
    const int time = what == "track" ? feature->GetFieldIndex("time") : -1;
    if (time >= 0 && feature->IsFieldSetAndNotNull(time)) point.time_s = seconds_of(*feature->GetRawFieldRef(time));
    line.parts.back().push_back(point);
    check_position_count(name, ++count);
  }
  std::vector<Line> result;
  for (auto& [id, line] : lines) result.push_back(std::move(line));
  return result;
}

std::vector<Line> gpx_waypoints(const std::string& name, OGRLayer& layer) {
  Line line{layer.GetName(), layer.GetName(), "points", {{}}, HeightReference::kAmsl};
  for (const auto& feature : layer) {
    const OGRGeometry* geometry = feature->GetGeometryRef();
    if (geometry == nullptr || wkbFlatten(geometry->getGeometryType()) != wkbPoint) continue;
    LinePoint point{geometry->toPoint()->getX(), geometry->toPoint()->getY()};
    const int elevation = feature->GetFieldIndex("ele");
    if (elevation >= 0 && feature->IsFieldSetAndNotNull(elevation)) point.z_m = feature->GetFieldAsDouble(elevation);
    line.parts[0].push_back(point);
    check_position_count(name, line.parts[0].size());
  }
  return line.parts[0].empty() ? std::vector<Line>{} : std::vector<Line>{line};
}

std::vector<Line> gpx_lines(Route& route, GDALDataset& dataset, const std::string& wanted_layer) {
  OGRLayer* layers[] = {dataset.GetLayerByName("routes"), dataset.GetLayerByName("route_points"),
                        dataset.GetLayerByName("tracks"), dataset.GetLayerByName("track_points"),
                        dataset.GetLayerByName("waypoints")};
  for (const OGRLayer* layer : layers) {
    if (layer == nullptr) throw DataError(route.name + ": OGR cannot list its routes and tracks");
  }
  const std::vector<std::function<std::vector<Line>()>> kinds = {
      [&] { return gpx_point_lines(route.name, *layers[0], *layers[1], "route_fid", nullptr, "route"); },
      [&] { return gpx_point_lines(route.name, *layers[2], *layers[3], "track_fid", "track_seg_id", "track"); },
      [&] { return gpx_waypoints(route.name, *layers[4]); }};
  std::vector<Line> chosen;
  for (const auto& kind : kinds) {
    std::vector<Line> lines = kind();
    if (lines.empty()) continue;
    if (chosen.empty() && (wanted_layer.empty() || lines.front().layer == wanted_layer)) {
      chosen = std::move(lines);
    } else {
      for (const Line& line : lines) {
        route.items.push_back({static_cast<int>(route.items.size()), -1, line.what + " \"" + line.name + "\"",
                               "left out: layer " + line.layer + " is not the one that is flown"});
      }
    }
  }
  return chosen;
}

}  // namespace

void bring_to_sea_level(const std::string& name, std::vector<RouteVertex>& vertices) {
  OGRSpatialReference ellipsoid;
  OGRSpatialReference geoid;
  ellipsoid.importFromProj4("+proj=longlat +datum=WGS84 +vunits=m +no_defs +type=crs +geoidgrids=@null");
  geoid.importFromProj4("+proj=longlat +datum=WGS84 +geoidgrids=egm96_15.gtx +vunits=m +no_defs +type=crs");
  for (auto* crs : {&ellipsoid, &geoid}) crs->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  const std::unique_ptr<OGRCoordinateTransformation> transform(OGRCreateCoordinateTransformation(&ellipsoid, &geoid));
  // The geoid lies about 17 m above the ellipsoid at 0, 0; without its grid PROJ would change nothing and say nothing.
  double x = 0;
  double y = 0;
  double z = 0;
  if (!transform || transform->Transform(1, &x, &y, &z) == FALSE || std::abs(z + 17.16) > 0.5) {
    throw DataError(name + ": heights above the ellipsoid need PROJ's grid egm96_15.gtx (Debian package proj-data)");
  }
  for (RouteVertex& vertex : vertices) {
    if (std::isnan(vertex.amsl_m)) continue;
    x = vertex.point.lon_deg;
    y = vertex.point.lat_deg;
    if (transform->Transform(1, &x, &y, &vertex.amsl_m) == FALSE || !std::isfinite(vertex.amsl_m)) {
      throw DataError(name + ": the height at lat " + format_number(y) + ", lon " + format_number(x) +
                      " cannot be brought from the ellipsoid to sea level");
    }
  }
}

Route parse_ogr_route(const std::string& name, std::string_view bytes, OgrFormat format, const RouteOptions& options) {
  if (options.home_amsl_m && options.height_reference != HeightReference::kHome) {
    throw UsageError("home_amsl_m is of no use for " + name + " without height_reference = home");
  }
  const OgrFile file(name, bytes, format);
  Route route;
  route.name = name;
  route.format = file.title();
  std::vector<Line> lines = format == OgrFormat::kGpx ? gpx_lines(route, file.dataset(), options.layer)
                                                      : vector_lines(route, file.dataset(), format, bytes);
  file.check_whole();
  apply_kml_tracks(route, file.tracks(), lines);
  const Line line = choose_line(route, std::move(lines), options);
  append_line(route, line);
  resolve_heights(route, line, options);
  apply_options(route, options);
  require_legs(route);
  return route;
}

}  // namespace pilotage
