#include "pilotage/route/read_route.h"

#include <array>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/utf8.h"
#include "pilotage/route/dji_wpml.h"
#include "pilotage/route/litchi_csv.h"
#include "pilotage/route/ogr_kmz.h"
#include "pilotage/route/ogr_route.h"
#include "pilotage/route/qgc_mission.h"
#include "pilotage/route/qgc_plan.h"
#include "pilotage/route/qgc_wpl.h"
#include "pilotage/route/route_size.h"
#include "pilotage/route/ugcs_csv.h"
#include "pilotage/route/ugcs_json.h"

namespace pilotage {
namespace {

bool is_geojson(const nlohmann::ordered_json& json) {
  const auto type = json.find("type");
  if (type == json.end() || !type->is_string()) return false;
  constexpr std::array<std::string_view, 9> kTypes = {"FeatureCollection", "Feature",      "Point",
                                                      "LineString",        "Polygon",      "MultiPoint",
                                                      "MultiLineString",   "MultiPolygon", "GeometryCollection"};
  const auto text = type->get<std::string>();
  for (const auto known : kTypes) {
    if (text == known) return true;
  }
  return false;
}

/// Mission files say themselves what heights mean and hold one mission; those of DJI may hold several waylines.
void refuse_vector_options(const std::string& name, const RouteOptions& options, bool may_choose = false) {
  const auto refuse = [&](const char* option) {
    throw UsageError(std::string(option) + " is for KML, GPX, GeoJSON and GeoPackage; " + name + " is a mission file");
  };
  if (options.height_reference != HeightReference::kAuto) refuse("height_reference");
  if (!options.layer.empty()) refuse("layer");
  if (!options.feature.empty() && !may_choose) refuse("feature");
}

Route parse_json_route(const std::string& name, std::string_view text, const RouteOptions& options) {
  check_json_route_size(name, text);
  const nlohmann::ordered_json json = parse_json(name, text);
  if (!json.is_object()) throw DataError(name + ": is JSON, but neither a QGroundControl plan nor GeoJSON");
  if (json.contains("fileType") || json.contains("mission")) {
    refuse_vector_options(name, options);
    return parse_qgc_plan(name, json, options);
  }
  if (is_qgc_mission(json)) {
    refuse_vector_options(name, options);
    return parse_qgc_mission(name, json, options);
  }
  if (is_ugcs_route(json)) {
    refuse_vector_options(name, options);
    return parse_ugcs_json(name, json, options);
  }
  if (is_geojson(json)) return parse_ogr_route(name, text, OgrFormat::kGeoJson, options);
  throw DataError(name +
                  ": is JSON, but neither a QGroundControl plan (\"fileType\": \"Plan\") nor GeoJSON (\"type\")");
}

Route parse_kmz_route(const std::string& name, std::string_view bytes, const RouteOptions& options) {
  const std::vector<KmzDocument> documents = unpack_kmz(name, bytes);
  std::string waylines;
  std::string mission_template;
  for (const KmzDocument& document : documents) {
    if (!is_dji_wpml(document.text)) continue;
    const bool is_executed = document.path == "waylines.wpml" || document.path.ends_with("/waylines.wpml");
    (is_executed ? waylines : mission_template) = document.text;
  }
  if (!waylines.empty() || !mission_template.empty()) {
    refuse_vector_options(name, options, true);
    for (const std::string* text : {&waylines, &mission_template}) check_kml_size(name, *text);
    return parse_dji_wpml(name, "DJI mission (KMZ)", waylines, mission_template, options);
  }
  const std::string& text = main_document(name, documents).text;
  check_kml_size(name, text);
  return parse_ogr_route(name, text, OgrFormat::kKmz, options);
}

/// Messages start with the file's name; the folder is needed to find it.
std::string in_folder(const std::filesystem::path& path, const std::string& message) {
  const std::string folder = path.parent_path().string();
  return folder.empty() ? message : folder + "/" + message;
}

/// One of the two documents of a DJI mission by itself; the path as it is executed has heights of its own kind.
Route parse_dji_document(const std::string& name, std::string_view text, const RouteOptions& options) {
  refuse_vector_options(name, options, true);
  const bool is_executed = text.find("executeHeightMode") != std::string_view::npos;
  return parse_dji_wpml(name, "DJI mission", is_executed ? text : "", is_executed ? "" : text, options);
}

}  // namespace

Route parse_route(const std::string& name, std::string_view bytes, const RouteOptions& options) {
  check_options(options);
  if (bytes.size() > kMaxRouteBytes) {
    throw DataError(name + ": has " + std::to_string(bytes.size()) + " bytes, at most " +
                    std::to_string(kMaxRouteBytes) + " are allowed");
  }
  if (is_qgc_wpl(bytes)) {
    refuse_vector_options(name, options);
    check_wpl_size(name, bytes);
    return parse_qgc_wpl(name, bytes, options);
  }
  if (bytes.starts_with(std::string_view("SQLite format 3\0", 16))) {
    return parse_ogr_route(name, bytes, OgrFormat::kGeoPackage, options);
  }
  if (bytes.starts_with("PK\x03\x04")) return parse_kmz_route(name, bytes, options);

  const std::string_view text = without_byte_order_mark(bytes);
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) throw DataError(name + ": is empty");
  if (text[first] == '{' || text[first] == '[') return parse_json_route(name, text, options);
  if (text[first] == '<') {
    const std::string_view head = text.substr(first, 4096);
    if (head.find("<gpx") != std::string_view::npos || head.find(":gpx") != std::string_view::npos) {
      check_gpx_size(name, text);
      return parse_ogr_route(name, text.substr(first), OgrFormat::kGpx, options);
    }
    if (head.find("<kml") != std::string_view::npos || head.find(":kml") != std::string_view::npos) {
      check_kml_size(name, text);
      if (is_dji_wpml(text.substr(first))) return parse_dji_document(name, text.substr(first), options);
      return parse_ogr_route(name, text.substr(first), OgrFormat::kKml, options);
    }
  }
  if (text.starts_with("#saved by ")) {
    throw DataError(
        name +
        ": is a polygon that Mission Planner or APM Planner saved, an area and no path; save the mission as "
        ".waypoints (QGC WPL 110)");
  }
  if (is_table(text)) {
    refuse_vector_options(name, options);
    if (is_ugcs_table(text)) return parse_ugcs_csv(name, text, options);
    return parse_litchi_csv(name, text, options);
  }
  throw DataError(name +
                  ": is not a route file that is known here: QGroundControl .plan, QGC WPL 110, DJI mission (KMZ, "
                  ".wpml), Litchi CSV, UgCS JSON or CSV, KML, KMZ, GPX, GeoJSON or GeoPackage");
}

Route read_route(const std::filesystem::path& path, const RouteOptions& options) {
  check_options(options);
  const std::string bytes = read_file(path, kMaxRouteBytes);
  try {
    return parse_route(name_as_utf8(path.filename().string()), bytes, options);
  } catch (const SeveralRoutesError& error) {
    throw SeveralRoutesError(in_folder(path, error.what()), error.choices());
  } catch (const DataError& error) {
    throw DataError(in_folder(path, error.what()));
  }
}

}  // namespace pilotage
