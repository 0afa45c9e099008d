#include "pilotage/gis/stac_item.h"

#include <algorithm>
#include <array>
#include <set>
#include <string_view>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/raster/gdal_vector.h"
#include "pilotage/verdict/quality.h"

namespace pilotage {
namespace {

using StacJson = nlohmann::ordered_json;

/// What a file is, by the end of its name; the longest that fits.
struct FileKind {
  std::string_view ending;
  const char* media_type;
  const char* role;
};

constexpr std::array<FileKind, 15> kFileKinds{
    {{".html", "text/html", "overview"},
     {".json", "application/json", "metadata"},
     {".tif.aux.xml", "application/xml", "metadata"},
     {".tif", "image/tiff; application=geotiff; profile=cloud-optimized", "data"},
     {".qml", "application/xml", "metadata"},
     {".gpkg", "application/geopackage+sqlite3", "data"},
     {"_dji.kmz", "application/vnd.google-earth.kmz", "data"},
     {".kmz", "application/vnd.google-earth.kmz", "visual"},
     {".kml", "application/vnd.google-earth.kml+xml", "visual"},
     {".geojson", "application/geo+json", "data"},
     {".csv", "text/csv", "data"},
     {".param", "text/plain", "data"},
     {".params", "text/plain", "data"},
     {".mbtiles", "application/vnd.sqlite3", "visual"},
     {".pmtiles", "application/vnd.pmtiles", "visual"}}};

StacJson asset(const std::string& file) {
  StacJson json;
  json["href"] = "./" + file;
  const auto kind = std::find_if(kFileKinds.begin(), kFileKinds.end(),
                                 [&](const FileKind& known) { return file.ends_with(known.ending); });
  if (kind != kFileKinds.end()) {
    json["type"] = kind->media_type;
    json["roles"] = {kind->role};
  }
  return json;
}

/// The rectangle around all tiles, its sides in parts, because they bend in degrees.
DegreeShape footprint(const Ground& ground) {
  Bounds around;
  for (const GroundTile& tile : ground.tiles) {
    const Bounds bounds = ground.level_of(tile).matrix.tile_bounds(tile.cell());
    around.extend({bounds.min_x_m, bounds.min_y_m});
    around.extend({bounds.max_x_m, bounds.max_y_m});
  }
  constexpr int kParts = 8;
  const std::array<Eigen::Vector2d, 4> corners{{{around.min_x_m, around.min_y_m},
                                                {around.max_x_m, around.min_y_m},
                                                {around.max_x_m, around.max_y_m},
                                                {around.min_x_m, around.max_y_m}}};
  VectorFeature feature;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    for (int part = 0; part < kParts; ++part) {
      const double along = static_cast<double>(part) / kParts;
      feature.points.push_back(corners[i] + along * (corners[(i + 1) % corners.size()] - corners[i]));
    }
  }
  VectorLayer layer;
  layer.name = "footprint";
  layer.shape = VectorShape::kPolygon;
  layer.crs = ground.crs;
  return degree_shape(layer, feature);
}

void add_times(const Imagery& imagery, StacJson& properties) {
  std::string first = "9999-12-31";
  std::string last = "1826-01-01";
  bool all_known = !imagery.datasets.empty();
  for (const ImageryDataset& dataset : imagery.datasets) {
    all_known = all_known && !dataset.acquired.empty();
    first = std::min(first, dataset.acquired);
    last = std::max(last, dataset.acquired);
  }
  if (!all_known) {
    first = "1826-01-01";
    last = "9999-12-31";
    properties["pilotage:imagery_dates"] = "not said by all of the imagery";
  }
  properties["datetime"] = nullptr;  // the days are known, not the hours
  properties["start_datetime"] = first + "T00:00:00Z";
  properties["end_datetime"] = last + "T23:59:59Z";
}

/// Letters, digits, "-", "." and "+", as licences are called in the list of SPDX.
bool is_spdx_like(const std::string& terms) {
  return std::all_of(terms.begin(), terms.end(), [](unsigned char c) {
    return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '-' || c == '.' ||
           c == '+';
  });
}

/// By its name, "proprietary" for one that has none there, "various" for several (STAC 1.0,
/// item-spec/common-metadata.md, "Licensing"); nothing where a part says none. All words stand beside it.
void add_licences(const Imagery& imagery, StacJson& properties) {
  std::set<std::string> terms;
  std::set<std::string> attributions;
  for (const ImageryDataset& dataset : imagery.datasets) {
    terms.insert(dataset.licence.terms);
    if (!dataset.licence.attribution.empty()) attributions.insert(dataset.licence.attribution);
  }
  const bool all_known = !terms.empty() && terms.erase("") == 0;
  if (all_known) {
    properties["license"] = terms.size() > 1               ? "various"
                            : is_spdx_like(*terms.begin()) ? *terms.begin()
                                                           : "proprietary";
  }
  if (!terms.empty()) properties["pilotage:licence"] = join({terms.begin(), terms.end()}, "; ");
  if (!attributions.empty())
    properties["pilotage:attribution"] = join({attributions.begin(), attributions.end()}, "; ");
}

}  // namespace

std::string stac_item(const ReportInput& input, const Report& report, const std::vector<std::string>& files) {
  const DegreeShape place = footprint(input.mission.ground);
  StacJson item;
  item["type"] = "Feature";
  item["stac_version"] = "1.0.0";
  item["stac_extensions"] = StacJson::array();
  item["id"] = report.title;
  item["geometry"] = StacJson::parse(place.geojson);
  item["bbox"] = {place.west_deg, place.south_deg, place.east_deg, place.north_deg};
  StacJson& properties = item["properties"];
  add_times(input.mission.ground.imagery, properties);
  properties["title"] = report.title;
  properties["description"] = report.verdict_text + "; " + report.assumptions;
  if (!input.mission.ground.levels.empty()) properties["gsd"] = input.mission.ground.levels.front().gsd_m;
  properties["pilotage:verdict"] = std::string(verdict_name(report.verdict));
  properties["pilotage:software_version"] = report.software_version;
  for (const InputFile& file : report.inputs) {
    if (file.role == "map" && !file.digest.empty()) properties["pilotage:map_digest"] = file.digest;
  }
  add_licences(input.mission.ground.imagery, properties);
  item["links"] = StacJson::array();
  StacJson assets = StacJson::object();
  for (const std::string& file : files) assets[file] = asset(file);
  item["assets"] = assets;
  return json_text(item);
}

}  // namespace pilotage
