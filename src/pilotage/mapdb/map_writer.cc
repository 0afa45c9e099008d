#include "pilotage/mapdb/map_writer.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/mapdb/descriptor_row.h"
#include "pilotage/mapdb/geometry_blob.h"
#include "pilotage/mapdb/geopackage_rows.h"
#include "pilotage/mapdb/map_digest.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/mapdb/map_schema.h"
#include "pilotage/mapdb/map_tables.h"

namespace pilotage {
namespace {

void bind_value(Statement& statement, int index, const MapValue& value, const MapColumn& column,
                const std::string& where) {
  struct Visitor {
    Statement& statement;
    int index;
    const MapColumn& column;
    const std::string& where;

    void operator()(std::monostate) const { statement.bind_null(index); }
    void operator()(std::int64_t integer) const {
      if (column.type == MapColumnType::kText) fail("an integer");
      statement.bind(index, integer);
    }
    void operator()(double number) const {
      if (column.type != MapColumnType::kReal) fail("a number");
      statement.bind(index, number);
    }
    void operator()(const std::string& text) const {
      if (column.type != MapColumnType::kText) fail("text");
      check_text(where + ": column " + column.name, text);
      statement.bind(index, std::string_view(text));
    }
    [[noreturn]] void fail(const char* given) const {
      throw UsageError(where + ": column " + column.name + " is " + sql_type(column.type) + ", but is given " + given);
    }
  };
  std::visit(Visitor{statement, index, column, where}, value);
}

void bind_values(Statement& statement, int first_index, const std::vector<MapValue>& values,
                 const std::vector<MapColumn>& columns, const std::string& where) {
  if (values.size() != columns.size()) {
    throw UsageError(where + ": has " + std::to_string(values.size()) + " values for " +
                     std::to_string(columns.size()) + " columns");
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    bind_value(statement, first_index + static_cast<int>(i), values[i], columns[i], where);
  }
}

void check_ascending(std::optional<std::pair<std::int64_t, int>>& last, std::pair<std::int64_t, int> key,
                     const std::string& where) {
  if (last && key <= *last) throw UsageError(where + ": rows must come in ascending order of tile and level");
  last = key;
}

}  // namespace

MapWriter::MapWriter(const std::filesystem::path& path, MapHeader header, bool overwrite)
    : header_(std::move(header)),
      output_(path, overwrite),
      database_(Database::create(output_.temporary_path(), path.string())),
      timestamp_(geopackage_timestamp()),
      srs_id_(srs_id_of(header_.crs)) {
  if (header_.crs.wkt.empty() || header_.crs.name.empty()) throw UsageError("crs: name or wkt is empty");
  check_text("crs", header_.crs.name);
  check_text("crs", header_.crs.wkt);
  check_text("crs", header_.crs.authority);
  check_text("description", header_.description);
  check_columns("tiles", header_.tile_columns);
  if (header_.levels.empty() || header_.levels.size() > kMaxLevels) {
    throw UsageError("levels: a map has 1 to " + std::to_string(kMaxLevels));
  }
  for (std::size_t i = 0; i < header_.levels.size(); ++i) {
    MapLevel& level = header_.levels[i];
    level.max_tile_radius_m = 0;
    const std::string problem = level_problem(level);
    if (!problem.empty()) throw UsageError("level " + std::to_string(level.matrix.level) + ": " + problem);
    if (i > 0 && header_.levels[i - 1].matrix.level >= level.matrix.level) {
      throw UsageError("levels: must come in ascending order, each once");
    }
  }
  create_tables();
  add_info("schema_version", std::to_string(header_.landmarks ? kMapSchemaVersion : kMapSchemaVersionWithoutLandmarks));
}

void MapWriter::create_tables() {
  database_.execute("PRAGMA application_id=" + std::to_string(kGeoPackageId) +
                    "; PRAGMA user_version=" + std::to_string(kGeoPackageVersion) + "; BEGIN;");
  database_.execute(create_geopackage_tables(is_wkt2(header_.crs.wkt)));
  database_.execute(create_map_tables(header_.tile_columns, header_.chips));
  if (header_.landmarks) database_.execute(create_landmark_tables());

  insert_spatial_reference_systems(database_, header_.crs);

  const int tile_values = static_cast<int>(kOwnTileColumns.size() + 1 + header_.tile_columns.size());
  insert_tile_.emplace(database_.prepare(insert_sql("tiles", tile_values), "tiles"));
  insert_box_.emplace(database_.prepare(insert_sql(kGridIndex, 5), kGridIndex));
  insert_center_.emplace(database_.prepare(insert_sql(kCenterIndex, 5), kCenterIndex));
  insert_info_.emplace(database_.prepare("INSERT INTO map_info (key, value) VALUES (?, ?)", "map_info"));
}

void MapWriter::add_tile(const MapTile& tile, const std::vector<MapValue>& values) {
  const std::string where = "tile " + std::to_string(tile.tile_id);
  if (tile.tile_id < 0) throw UsageError(where + ": a tile_id is at least 0");
  if (!tiles_.empty() && tile.tile_id <= tiles_.back().tile_id) {
    throw UsageError(where + ": comes after tile " + std::to_string(tiles_.back().tile_id) +
                     "; tiles must come in ascending order");
  }
  const std::string problem = tile_problem(tile);
  if (!problem.empty()) throw UsageError(where + ": " + problem);
  MapLevel& level = level_of(tile.level, where);
  level.max_tile_radius_m = std::max(level.max_tile_radius_m, tile_radius_m(tile));

  const Bounds& b = tile.bounds;
  Statement& row = *insert_tile_;
  row.bind(1, tile.tile_id).bind(2, std::span<const std::uint8_t>(polygon_blob(b, static_cast<std::int32_t>(srs_id_))));
  row.bind(3, std::int64_t{tile.level}).bind(4, tile.column).bind(5, tile.row);
  row.bind(6, b.min_x_m).bind(7, b.min_y_m).bind(8, b.max_x_m).bind(9, b.max_y_m);
  row.bind(10, tile.center.lon_deg).bind(11, tile.center.lat_deg);
  row.bind(12, tile.enu_from_grid(0, 0)).bind(13, tile.enu_from_grid(0, 1));
  row.bind(14, tile.enu_from_grid(1, 0)).bind(15, tile.enu_from_grid(1, 1));
  bind_values(row, 16, values, header_.tile_columns, where);
  row.run();
  insert_box_->bind(1, tile.tile_id).bind(2, b.min_x_m).bind(3, b.max_x_m).bind(4, b.min_y_m).bind(5, b.max_y_m);
  insert_box_->run();
  const GeodeticPoint c = tile.center;
  insert_center_->bind(1, tile.tile_id).bind(2, c.lon_deg).bind(3, c.lon_deg).bind(4, c.lat_deg).bind(5, c.lat_deg);
  insert_center_->run();
  tile_extent_.extend({b.min_x_m, b.min_y_m});
  tile_extent_.extend({b.max_x_m, b.max_y_m});
  tiles_.push_back({tile.tile_id, b});
}

MapLevel& MapWriter::level_of(int level, const std::string& where) {
  for (MapLevel& candidate : header_.levels) {
    if (candidate.matrix.level == level) return candidate;
  }
  throw UsageError(where + ": level " + std::to_string(level) + " is not one of the map's levels");
}

// tiles_near finds a tile by its footprint, so nothing that belongs to it may lie outside.
void MapWriter::check_window(std::int64_t tile_id, int level, const PixelWindow& window, int slack_px,
                             const std::string& where) {
  const std::string problem = window_problem(window);
  if (!problem.empty()) throw UsageError(where + ": " + problem);
  const MapLevel& map_level = level_of(level, where);
  const auto tile = std::lower_bound(tiles_.begin(), tiles_.end(), tile_id,
                                     [](const StoredTile& stored, std::int64_t id) { return stored.tile_id < id; });
  if (tile == tiles_.end() || tile->tile_id != tile_id) throw UsageError(where + ": its tile has not been added");
  const GeoTransform& transform = map_level.matrix.map_from_pixel;
  const Bounds allowed = tile->bounds.grown(slack_px * std::sqrt(std::abs(transform.determinant())));
  const auto col = static_cast<double>(window.col);
  const auto row = static_cast<double>(window.row);
  for (const Eigen::Vector2d& corner :
       {Eigen::Vector2d(col, row), Eigen::Vector2d(col + window.width, row), Eigen::Vector2d(col, row + window.height),
        Eigen::Vector2d(col + window.width, row + window.height)}) {
    const Eigen::Vector2d p = transform.map_from_pixel(corner);
    if (p.x() < allowed.min_x_m || p.x() > allowed.max_x_m || p.y() < allowed.min_y_m || p.y() > allowed.max_y_m) {
      throw UsageError(where + ": its window reaches (" + format_number(p.x()) + ", " + format_number(p.y()) +
                       "), more than " + std::to_string(slack_px) + " px outside the footprint of its tile");
    }
  }
}

void MapWriter::add_descriptors(const TileDescriptors& descriptors) {
  const std::string where =
      "descriptors of tile " + std::to_string(descriptors.tile_id) + ", level " + std::to_string(descriptors.level);
  check_window(descriptors.tile_id, descriptors.level, descriptors.window, 1, where);
  check_ascending(last_descriptors_, {descriptors.tile_id, descriptors.level}, where);
  const EncodedKeypoints keypoints = encode_keypoints(descriptors, where);
  DescriptorRow row;
  row.tile_id = descriptors.tile_id;
  row.level = descriptors.level;
  row.window = descriptors.window;
  row.count = static_cast<std::int64_t>(descriptors.features.size());
  row.descriptor_bytes = descriptors.features.descriptor_bytes;
  row.ground_base_m = keypoints.ground_base_m;
  row.keypoints = keypoints.bytes;
  row.descriptors = descriptors.features.descriptors;
  const Digest digest = descriptor_digest(row);

  if (!insert_descriptors_) {
    insert_descriptors_.emplace(database_.prepare(
        "INSERT INTO pilotage_descriptors (" + std::string(kDescriptorColumns) + ") VALUES (?,?,?,?,?,?,?,?,?,?,?,?)",
        "pilotage_descriptors"));
  }
  Statement& insert = *insert_descriptors_;
  insert.bind(1, row.tile_id).bind(2, std::int64_t{row.level});
  insert.bind(3, row.window.col).bind(4, row.window.row);
  insert.bind(5, std::int64_t{row.window.width}).bind(6, std::int64_t{row.window.height});
  insert.bind(7, row.count).bind(8, std::int64_t{row.descriptor_bytes});
  insert.bind(9, row.ground_base_m.value_or(std::numeric_limits<double>::quiet_NaN()));
  insert.bind(10, row.keypoints).bind(11, row.descriptors).bind(12, std::span<const std::uint8_t>(digest));
  insert.run();
}

void MapWriter::add_chip(const MapChip& chip) {
  const std::string where = "chip of tile " + std::to_string(chip.tile_id) + ", level " + std::to_string(chip.level);
  if (!header_.chips) throw UsageError(where + ": the map was begun without chips");
  check_window(chip.tile_id, chip.level, chip.window, kMaxChipFactor / 2, where);
  check_ascending(last_chip_, {chip.tile_id, chip.level}, where);
  check_text(where, chip.encoding);
  const std::string problem = chip_problem(chip);
  if (!problem.empty()) throw UsageError(where + ": " + problem);
  const Digest digest = chip_digest(chip);
  if (!insert_chip_) {
    insert_chip_.emplace(database_.prepare(
        "INSERT INTO pilotage_chips (" + std::string(kChipColumns) + ") VALUES (?,?,?,?,?,?,?,?,?)", "pilotage_chips"));
  }
  Statement& insert = *insert_chip_;
  insert.bind(1, chip.tile_id).bind(2, std::int64_t{chip.level});
  insert.bind(3, chip.window.col).bind(4, chip.window.row);
  insert.bind(5, std::int64_t{chip.window.width}).bind(6, std::int64_t{chip.window.height});
  insert.bind(7, std::string_view(chip.encoding)).bind(8, std::span<const std::uint8_t>(chip.data));
  insert.bind(9, std::span<const std::uint8_t>(digest));
  insert.run();
}

void MapWriter::write_landmarks(const MapLandmarks& landmarks) {
  if (!header_.landmarks) throw UsageError("landmarks: the map was begun without them");
  if (landmarks_written_) throw UsageError("landmarks: are written twice");
  const std::string too_much = map_landmarks_problem(landmarks);
  if (!too_much.empty()) throw UsageError("landmarks: " + too_much);
  landmarks_written_ = true;
  Statement detector = database_.prepare(insert_sql("pilotage_detectors", 17), "pilotage_detectors");
  for (std::size_t i = 0; i < landmarks.detectors.size(); ++i) {
    const MapDetector& one = landmarks.detectors[i];
    const LandmarkDetector& d = one.detector;
    const std::string where = "detector " + std::to_string(i);
    const std::string problem = detector_problem(one);
    if (!problem.empty()) throw UsageError(where + ": " + problem);
    check_text(where, d.class_name);
    detector.bind(1, static_cast<std::int64_t>(i)).bind(2, std::string_view(d.class_name)).bind(3, d.gsd_m);
    detector.bind(4, std::int64_t{d.window.side_px}).bind(5, std::int64_t{d.window.cell_px});
    detector.bind(6, std::int64_t{d.window.levels}).bind(7, d.context);
    detector.bind(8, d.offset.x()).bind(9, d.offset.y()).bind(10, d.period_deg).bind(11, d.threshold);
    detector.bind(12, d.shortest_m).bind(13, d.longest_m);
    detector.bind(14, one.p_detect).bind(15, one.false_alarms_per_km2).bind(16, one.sigma_m);
    const std::vector<std::uint8_t> filters = filter_bytes(d);
    if (filters.size() > static_cast<std::size_t>(kMaxMapBlobBytes)) {
      throw UsageError(where + ": its filters take " + std::to_string(filters.size()) + " bytes, too many for a map");
    }
    detector.bind(17, std::span<const std::uint8_t>(filters));
    detector.run();
  }
  Statement insert = database_.prepare(insert_sql("landmarks", 9), "landmarks");
  for (std::size_t i = 0; i < landmarks.landmarks.size(); ++i) {
    const MapLandmark& landmark = landmarks.landmarks[i];
    const std::string where = "landmark " + std::to_string(landmark.id);
    if (i > 0 && landmark.id <= landmarks.landmarks[i - 1].id) throw UsageError(where + ": ids must ascend");
    const std::string problem = landmark_problem(landmark, landmarks.detectors.size());
    if (!problem.empty()) throw UsageError(where + ": " + problem);
    insert.bind(1, landmark.id).bind(2, std::span<const std::uint8_t>(point_blob(landmark.place)));
    insert.bind(3, static_cast<std::int64_t>(landmark.detector));
    insert.bind(4, landmark.place.lon_deg).bind(5, landmark.place.lat_deg).bind(6, landmark.length_m);
    insert.bind(7, landmark.ground_height_m).bind(8, std::int64_t{landmark.found ? 1 : 0});
    insert.bind(9, landmark.ambiguity);
    insert.run();
    landmarks_extent_deg_.extend({landmark.place.lon_deg, landmark.place.lat_deg});
  }
}

void MapWriter::write_route(const std::vector<MapColumn>& columns, const std::vector<MapLine>& lines) {
  write_lines(route_, columns, lines);
}

void MapWriter::write_legs(const std::vector<MapColumn>& columns, const std::vector<MapLine>& lines) {
  write_lines(legs_, columns, lines);
}

void MapWriter::write_lines(LineLayer& layer, const std::vector<MapColumn>& columns,
                            const std::vector<MapLine>& lines) {
  if (layer.written) throw UsageError(layer.name + ": is written twice");
  check_columns(layer.name, columns);
  std::vector<std::vector<std::vector<GeodeticPoint>>> parts;
  bool multi = false;
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string where = layer.name + ": line " + std::to_string(lines[i].id);
    if (i > 0 && lines[i].id <= lines[i - 1].id) throw UsageError(where + ": ids must ascend");
    if (lines[i].points.size() < 2) throw UsageError(where + ": has less than two points");
    for (const GeodeticPoint point : lines[i].points) {
      if (!std::isfinite(point.lon_deg) || !(std::abs(point.lat_deg) <= 90)) {
        throw UsageError(where + ": (lon " + format_number(point.lon_deg) + ", lat " + format_number(point.lat_deg) +
                         ") is not on Earth");
      }
    }
    parts.push_back(cut_at_antimeridian(lines[i].points));
    multi = multi || parts.back().size() > 1;
  }
  layer.written = true;
  layer.columns = columns;
  layer.geometry_type = multi ? "MULTILINESTRING" : "LINESTRING";
  database_.execute(create_line_table(layer.name, layer.geometry_type, columns));
  Statement insert = database_.prepare(insert_sql(layer.name, 2 + static_cast<int>(columns.size())), layer.name);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string where = layer.name + ": line " + std::to_string(lines[i].id);
    insert.bind(1, lines[i].id).bind(2, std::span<const std::uint8_t>(line_blob(parts[i], multi)));
    bind_values(insert, 3, lines[i].values, columns, where);
    insert.run();
    for (const auto& part : parts[i]) {
      for (const GeodeticPoint point : part) layer.extent_deg.extend({point.lon_deg, point.lat_deg});
    }
  }
}

void MapWriter::add_info(const std::string& key, const std::string& value) {
  const std::string where = "map_info: key \"" + key + "\"";
  check_text(where, key);
  check_text(where, value);
  const bool own = key == "content_digest" || (key == "schema_version" && !info_keys_.empty());
  if (own) throw UsageError(where + ": is written by the map itself");
  if (key.empty() || !info_keys_.insert(key).second) throw UsageError(where + ": is empty or given twice");
  insert_info_->bind(1, std::string_view(key)).bind(2, std::string_view(value));
  insert_info_->run();
}

void MapWriter::write_levels() {
  Statement insert = database_.prepare(
      "INSERT INTO pilotage_levels (" + std::string(kLevelColumns) + ") VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)",
      "pilotage_levels");
  for (const MapLevel& level : header_.levels) {
    const TileMatrix& m = level.matrix;
    const GeoTransform& t = m.map_from_pixel;
    insert.bind(1, std::int64_t{m.level}).bind(2, level.gsd_m).bind(3, level.min_agl_m).bind(4, level.max_agl_m);
    insert.bind(5, t.origin_x).bind(6, t.x_per_col).bind(7, t.x_per_row);
    insert.bind(8, t.origin_y).bind(9, t.y_per_col).bind(10, t.y_per_row);
    insert.bind(11, m.grid_width_px).bind(12, m.grid_height_px);
    insert.bind(13, std::int64_t{m.tile_size_px}).bind(14, std::int64_t{m.stride_px});
    insert.bind(15, level.max_tile_radius_m);
    insert.run();
  }
}

void MapWriter::write_contents() {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Statement contents = database_.prepare(insert_sql("gpkg_contents", 10), "gpkg_contents");
  const auto add = [&](std::string_view table, std::string_view type, std::string_view description,
                       const Bounds& extent, std::optional<std::int64_t> srs_id) {
    contents.bind(1, table).bind(2, type).bind(3, table).bind(4, description).bind(5, std::string_view(timestamp_));
    contents.bind(6, extent.empty() ? kNone : extent.min_x_m).bind(7, extent.empty() ? kNone : extent.min_y_m);
    contents.bind(8, extent.empty() ? kNone : extent.max_x_m).bind(9, extent.empty() ? kNone : extent.max_y_m);
    if (srs_id) contents.bind(10, *srs_id);
    contents.run();
  };
  add("tiles", "features", header_.description, tile_extent_, srs_id_);
  add("route", "features", "The planned route.", route_.extent_deg, 4326);
  add("legs", "features", "The legs of the route and whether they can be matched.", legs_.extent_deg, 4326);
  if (header_.landmarks) {
    add("landmarks", "features", "What detectors of the map find.", landmarks_extent_deg_, 4326);
  }
  add("map_info", "attributes", "How the map was made.", {}, std::nullopt);

  Statement geometry = database_.prepare(insert_sql("gpkg_geometry_columns", 6), "gpkg_geometry_columns");
  const auto add_geometry = [&](std::string_view table, std::string_view type, std::int64_t srs_id) {
    geometry.bind(1, table).bind(2, std::string_view("geom")).bind(3, type).bind(4, srs_id);
    geometry.bind(5, std::int64_t{0}).bind(6, std::int64_t{0});
    geometry.run();
  };
  add_geometry("tiles", "POLYGON", srs_id_);
  add_geometry("route", route_.geometry_type, 4326);
  add_geometry("legs", legs_.geometry_type, 4326);
  if (header_.landmarks) add_geometry("landmarks", "POINT", 4326);
}

std::string MapWriter::finish() {
  if (finished_) throw UsageError("the map is finished already");
  if (!route_.written) write_lines(route_, {}, {});
  if (!legs_.written) write_lines(legs_, {}, {});
  write_levels();
  write_contents();
  insert_extensions(database_, is_wkt2(header_.crs.wkt), header_.chips, header_.landmarks);
  insert_column_descriptions(database_, "tiles", header_.tile_columns);
  if (header_.landmarks) {
    insert_column_descriptions(
        database_, "landmarks",
        {{"detector", MapColumnType::kInteger, "Of pilotage_detectors"},
         {"length_m", MapColumnType::kReal, "Length [m]"},
         {"ground_height_m", MapColumnType::kReal, "Of the ground, above mean sea level [m]"},
         {"found", MapColumnType::kInteger, "1 when its detector found it on another date"},
         {"ambiguity", MapColumnType::kReal, "Expected hits of its class near it that are not it"}});
  }
  insert_column_descriptions(database_, "route", route_.columns);
  insert_column_descriptions(database_, "legs", legs_.columns);
  database_.execute(create_rtree_triggers());
  const std::string digest = to_hex(content_digest(database_));
  insert_info_->bind(1, std::string_view("content_digest")).bind(2, std::string_view(digest));
  insert_info_->run();
  database_.execute("COMMIT;");
  for (auto* statement :
       {&insert_tile_, &insert_box_, &insert_center_, &insert_descriptors_, &insert_chip_, &insert_info_}) {
    statement->reset();
  }
  database_.close();
  output_.commit();
  finished_ = true;
  return digest;
}

}  // namespace pilotage
