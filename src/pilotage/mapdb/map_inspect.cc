#include "pilotage/mapdb/map_inspect.h"

#include <cmath>
#include <limits>
#include <string_view>
#include <system_error>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/map_schema.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(double number) {
  return std::isfinite(number) ? Json(number) : Json(nullptr);
}

std::string_view type_name(MapColumnType type) {
  switch (type) {
    case MapColumnType::kInteger:
      return "integer";
    case MapColumnType::kText:
      return "text";
    case MapColumnType::kReal:
      break;
  }
  return "number";
}

Json to_json(const MapLevelSummary& summary) {
  const TileMatrix& m = summary.level.matrix;
  const GeoTransform& t = m.map_from_pixel;
  Json json;
  json["level"] = m.level;
  json["gsd_m"] = summary.level.gsd_m;
  json["min_agl_m"] = number_or_null(summary.level.min_agl_m);
  json["max_agl_m"] = number_or_null(summary.level.max_agl_m);
  json["map_from_pixel"] = {t.origin_x, t.x_per_col, t.x_per_row, t.origin_y, t.y_per_col, t.y_per_row};
  json["grid_width_px"] = m.grid_width_px;
  json["grid_height_px"] = m.grid_height_px;
  json["tile_size_px"] = m.tile_size_px;
  json["stride_px"] = m.stride_px;
  json["max_tile_radius_m"] = summary.level.max_tile_radius_m;
  json["tiles"] = summary.tiles;
  json["tiles_with_descriptors"] = summary.tiles_with_descriptors;
  json["descriptors"] = summary.descriptors;
  json["descriptor_blob_bytes"] = summary.descriptor_blob_bytes;
  json["chips"] = summary.chips;
  json["chip_bytes"] = summary.chip_bytes;
  return json;
}

// count(*) of a whole table is one step of SQLite, however long it takes; count(column) is a step or more a row, which
// the limit of what reading may cost can end.
MapLevelSummary summarize_level(const MapLevel& level, const Database& database, bool chips) {
  MapLevelSummary summary;
  summary.level = level;
  const std::string where = " WHERE level = " + std::to_string(level.matrix.level);
  summary.tiles = database.query_integer("SELECT count(tile_id) FROM tiles" + where, "tiles");
  Statement statement = database.prepare(
      "SELECT count(*), ifnull(sum(count), 0), ifnull(sum(length(keypoints) + length(descriptors)), 0) "
      "FROM pilotage_descriptors" +
          where,
      "pilotage_descriptors");
  if (statement.step()) {
    summary.tiles_with_descriptors = statement.integer(0);
    summary.descriptors = statement.integer(1);
    summary.descriptor_blob_bytes = statement.integer(2);
  }
  if (!chips) return summary;
  Statement chip =
      database.prepare("SELECT count(*), ifnull(sum(length(data)), 0) FROM pilotage_chips" + where, "pilotage_chips");
  if (chip.step()) {
    summary.chips = chip.integer(0);
    summary.chip_bytes = chip.integer(1);
  }
  return summary;
}

}  // namespace

bool declares_map(const std::filesystem::path& path) {
  try {
    return read_declarations(Database::open_untrusted(path, kMaxMapBlobBytes)).contains("map_info");
  } catch (const DataError&) {
    return false;
  }
}

MapSummary inspect_map(const std::filesystem::path& path) {
  const MapReader reader = MapReader::open_unverified(path);
  Database database = Database::open_untrusted(path, kMaxMapBlobBytes);
  database.renew_cost();
  MapSummary summary;
  summary.file = path.filename().string();
  std::error_code error;
  summary.file_bytes = static_cast<std::int64_t>(std::filesystem::file_size(path, error));
  if (error) throw DataError(path.string() + ": cannot be read: " + error.message());
  summary.info = reader.info();
  summary.tile_columns = reader.tile_columns();
  std::int64_t descriptor_bytes = 0;
  std::int64_t chip_bytes = 0;
  for (const MapLevel& level : reader.levels()) {
    summary.levels.push_back(summarize_level(level, database, reader.has_chips()));
    descriptor_bytes += summary.levels.back().descriptor_blob_bytes;
    chip_bytes += summary.levels.back().chip_bytes;
  }
  summary.tiles = database.query_integer("SELECT count(tile_id) FROM tiles", "tiles");
  summary.route_lines = database.query_integer("SELECT count(fid) FROM route", "route");
  summary.legs = database.query_integer("SELECT count(fid) FROM legs", "legs");
  if (reader.has_landmarks()) {
    summary.landmarks = database.query_integer("SELECT count(fid) FROM landmarks", "landmarks");
    Statement classes = database.prepare("SELECT class FROM pilotage_detectors ORDER BY id", "pilotage_detectors");
    while (classes.step()) summary.landmark_classes.emplace_back(classes.text(0));
  }
  const std::string owners = std::string("SELECT count(*) FROM (SELECT tile_id FROM pilotage_descriptors") +
                             (reader.has_chips() ? " UNION SELECT tile_id FROM pilotage_chips)" : " GROUP BY tile_id)");
  const std::int64_t tiles_with_data = database.query_integer(owners, "pilotage_descriptors");
  const double tiles =
      tiles_with_data == 0 ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(tiles_with_data);
  summary.descriptor_bytes_per_tile = static_cast<double>(descriptor_bytes) / tiles;
  summary.chip_bytes_per_tile = static_cast<double>(chip_bytes) / tiles;
  summary.bytes_per_tile = static_cast<double>(descriptor_bytes + chip_bytes) / tiles;
  Statement extensions =
      database.prepare("SELECT DISTINCT extension_name FROM gpkg_extensions ORDER BY 1", "gpkg_extensions");
  while (extensions.step()) summary.extensions.emplace_back(extensions.text(0));
  return summary;
}

nlohmann::ordered_json to_json(const MapSummary& summary) {
  Json json;
  json["file"] = summary.file;
  json["file_bytes"] = summary.file_bytes;
  json["schema_version"] = summary.info.schema_version;
  json["crs"] = {
      {"name", summary.info.crs.name}, {"authority", summary.info.crs.authority}, {"wkt", summary.info.crs.wkt}};
  json["tiles"] = summary.tiles;
  json["route_lines"] = summary.route_lines;
  json["legs"] = summary.legs;
  json["landmarks"] = summary.landmarks;
  json["landmark_classes"] = summary.landmark_classes;
  json["bytes_per_tile"] = number_or_null(summary.bytes_per_tile);
  json["descriptor_bytes_per_tile"] = number_or_null(summary.descriptor_bytes_per_tile);
  json["chip_bytes_per_tile"] = number_or_null(summary.chip_bytes_per_tile);
  json["levels"] = Json::array();
  for (const MapLevelSummary& level : summary.levels) json["levels"].push_back(to_json(level));
  json["tile_columns"] = Json::array();
  for (const MapColumn& column : summary.tile_columns) {
    json["tile_columns"].push_back(
        {{"name", column.name}, {"type", type_name(column.type)}, {"description", column.description}});
  }
  json["extensions"] = summary.extensions;
  json["map_info"] = Json::object();
  for (const MapInfoEntry& entry : summary.info.entries) json["map_info"][entry.key] = entry.value;
  return json;
}

}  // namespace pilotage
