#include "pilotage/mapdb/map_schema.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/base/utf8.h"
#include "pilotage/mapdb/map_tables.h"

namespace pilotage {
namespace {

constexpr std::size_t kMaxColumns = 500;
constexpr std::size_t kMaxNameLength = 60;

std::string column_list(const std::vector<MapColumn>& columns) {
  std::string sql;
  for (const MapColumn& column : columns) sql += ", \"" + column.name + "\" " + sql_type(column.type);
  return sql;
}

bool good_name(std::string_view name) {
  const auto good = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_'; };
  return !name.empty() && name.size() <= kMaxNameLength && !(name[0] >= '0' && name[0] <= '9') &&
         std::all_of(name.begin(), name.end(), good);
}

bool reserved_name(std::string_view name) {
  for (const char* reserved : {"fid", "geom", "rowid", "oid", "_rowid_", "ogc_fid"}) {
    if (name == reserved) return true;
  }
  return std::find(kOwnTileColumns.begin(), kOwnTileColumns.end(), name) != kOwnTileColumns.end();
}

constexpr std::size_t kMaxDeclarations = 64;

/// The SQL of several statements, each on lines of its own, as SQLite keeps it: without the end.
std::vector<std::string> statements_of(std::string_view sql) {
  std::vector<std::string> statements;
  constexpr std::string_view kEnd = ";\n";
  while (!sql.empty()) {
    while (sql.starts_with('\n')) sql.remove_prefix(1);
    const std::size_t end = sql.find(kEnd);
    const std::string_view statement = sql.substr(0, end);
    if (!statement.empty()) statements.emplace_back(statement);
    sql.remove_prefix(end == std::string_view::npos ? sql.size() : end + kEnd.size());
  }
  return statements;
}

/// "tiles" of "CREATE TABLE tiles (…".
std::string declared_name(const std::string& statement) {
  for (const std::string_view begin : {"CREATE TABLE ", "CREATE VIRTUAL TABLE ", "CREATE TRIGGER "}) {
    if (statement.starts_with(begin))
      return statement.substr(begin.size(), statement.find(' ', begin.size()) - begin.size());
  }
  return {};
}

/// The tables that SQLite's R-tree keeps its nodes in, as SQLite from 3.24 on declares them.
std::vector<std::pair<std::string, std::string>> shadow_tables(std::string_view rtree) {
  const std::string name(rtree);
  const auto table = [&](const std::string& suffix, const std::string& columns) {
    return std::pair(name + suffix, "CREATE TABLE \"" + name + suffix + "\"(" + columns + ")");
  };
  return {table("_rowid", "rowid INTEGER PRIMARY KEY,nodeno"), table("_node", "nodeno INTEGER PRIMARY KEY,data"),
          table("_parent", "nodeno INTEGER PRIMARY KEY,parentnode")};
}

/// What a map may declare: the SQL of each name, in all forms that it may have. Of the layers, where the columns of
/// stages follow, what comes before these.
struct WrittenSchema {
  std::multimap<std::string, std::string, std::less<>> whole;
  std::multimap<std::string, std::string, std::less<>> layers;
};

WrittenSchema written_schema() {
  WrittenSchema schema;
  std::set<std::string> statements;
  for (const std::string& sql : {create_geopackage_tables(false), create_geopackage_tables(true),
                                 create_map_tables({}, true), create_landmark_tables(), create_rtree_triggers()}) {
    for (const std::string& statement : statements_of(sql)) statements.insert(statement);
  }
  for (const std::string& statement : statements) schema.whole.emplace(declared_name(statement), statement);
  for (const std::string_view rtree : {kGridIndex, kCenterIndex}) {
    for (auto& [name, sql] : shadow_tables(rtree)) schema.whole.emplace(name, sql);
  }
  const auto tiles = schema.whole.find("tiles");
  schema.layers.emplace("tiles", tiles->second.substr(0, tiles->second.size() - 1));
  schema.whole.erase(tiles);
  for (const char* layer : {"route", "legs"}) {
    for (const char* geometry : {"LINESTRING", "MULTILINESTRING"}) {
      const std::string sql = create_line_table(layer, geometry, {});
      schema.layers.emplace(layer, sql.substr(0, sql.size() - std::string_view(");").size()));
    }
  }
  return schema;
}

const WrittenSchema& written() {
  static const WrittenSchema schema = written_schema();
  return schema;
}

/// Whether `sql` is a list of columns of stages as column_list writes it, and the end.
bool ends_with_columns(std::string_view sql) {
  for (std::size_t columns = 0; columns < kMaxColumns && sql.starts_with(", \""); ++columns) {
    sql.remove_prefix(3);
    const std::size_t quote = sql.find('"');
    if (quote == std::string_view::npos || !good_name(sql.substr(0, quote)) || reserved_name(sql.substr(0, quote))) {
      return false;
    }
    sql.remove_prefix(quote + 1);
    const auto is_next = [&](std::string_view type) { return sql.starts_with(type); };
    const auto types = {std::string_view(" INTEGER"), std::string_view(" REAL"), std::string_view(" TEXT")};
    const auto* const type = std::find_if(types.begin(), types.end(), is_next);
    if (type == types.end()) return false;
    sql.remove_prefix(type->size());
  }
  return sql == ")";
}

bool is_as_written(std::string_view name, std::string_view sql) {
  const auto [first, last] = written().whole.equal_range(name);
  if (std::any_of(first, last, [&](const auto& form) { return form.second == sql; })) return true;
  const auto [first_layer, last_layer] = written().layers.equal_range(name);
  return std::any_of(first_layer, last_layer, [&](const auto& form) {
    return sql.starts_with(form.second) && ends_with_columns(sql.substr(form.second.size()));
  });
}

}  // namespace

std::string create_geopackage_tables(bool with_wkt2) {
  return std::string(R"sql(
CREATE TABLE gpkg_spatial_ref_sys (
  srs_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL PRIMARY KEY,
  organization TEXT NOT NULL,
  organization_coordsys_id INTEGER NOT NULL,
  definition TEXT NOT NULL,
  description TEXT)sql") +
         (with_wkt2 ? ",\n  definition_12_063 TEXT NOT NULL);" : ");") + R"sql(
CREATE TABLE gpkg_contents (
  table_name TEXT NOT NULL PRIMARY KEY,
  data_type TEXT NOT NULL,
  identifier TEXT UNIQUE,
  description TEXT DEFAULT '',
  last_change DATETIME NOT NULL DEFAULT (strftime('%Y-%m-%dT%H:%M:%fZ','now')),
  min_x DOUBLE,
  min_y DOUBLE,
  max_x DOUBLE,
  max_y DOUBLE,
  srs_id INTEGER,
  CONSTRAINT fk_gc_r_srs_id FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id));
CREATE TABLE gpkg_geometry_columns (
  table_name TEXT NOT NULL,
  column_name TEXT NOT NULL,
  geometry_type_name TEXT NOT NULL,
  srs_id INTEGER NOT NULL,
  z TINYINT NOT NULL,
  m TINYINT NOT NULL,
  CONSTRAINT pk_geom_cols PRIMARY KEY (table_name, column_name),
  CONSTRAINT uk_gc_table_name UNIQUE (table_name),
  CONSTRAINT fk_gc_tn FOREIGN KEY (table_name) REFERENCES gpkg_contents (table_name),
  CONSTRAINT fk_gc_srs FOREIGN KEY (srs_id) REFERENCES gpkg_spatial_ref_sys (srs_id));
CREATE TABLE gpkg_extensions (
  table_name TEXT,
  column_name TEXT,
  extension_name TEXT NOT NULL,
  definition TEXT NOT NULL,
  scope TEXT NOT NULL,
  CONSTRAINT ge_tce UNIQUE (table_name, column_name, extension_name));
CREATE TABLE gpkg_data_columns (
  table_name TEXT NOT NULL,
  column_name TEXT NOT NULL,
  name TEXT,
  title TEXT,
  description TEXT,
  mime_type TEXT,
  constraint_name TEXT,
  CONSTRAINT pk_gdc PRIMARY KEY (table_name, column_name),
  CONSTRAINT gdc_tn UNIQUE (table_name, name));
CREATE TABLE gpkg_data_column_constraints (
  constraint_name TEXT NOT NULL,
  constraint_type TEXT NOT NULL,
  value TEXT,
  min NUMERIC,
  min_is_inclusive BOOLEAN,
  max NUMERIC,
  max_is_inclusive BOOLEAN,
  description TEXT,
  CONSTRAINT gdcc_ntv UNIQUE (constraint_name, constraint_type, value));
)sql";
}

std::string create_map_tables(const std::vector<MapColumn>& tile_columns, bool chips) {
  std::string sql = R"sql(
CREATE TABLE map_info (id INTEGER PRIMARY KEY NOT NULL, key TEXT NOT NULL UNIQUE, value TEXT NOT NULL);
CREATE TABLE pilotage_levels (
  level INTEGER PRIMARY KEY NOT NULL,
  gsd_m REAL NOT NULL,
  min_agl_m REAL,
  max_agl_m REAL,
  origin_x REAL NOT NULL,
  x_per_col REAL NOT NULL,
  x_per_row REAL NOT NULL,
  origin_y REAL NOT NULL,
  y_per_col REAL NOT NULL,
  y_per_row REAL NOT NULL,
  grid_width_px INTEGER NOT NULL,
  grid_height_px INTEGER NOT NULL,
  tile_size_px INTEGER NOT NULL,
  stride_px INTEGER NOT NULL,
  max_tile_radius_m REAL NOT NULL);
CREATE TABLE tiles (
  tile_id INTEGER PRIMARY KEY NOT NULL,
  geom POLYGON NOT NULL,
  level INTEGER NOT NULL,
  "column" INTEGER NOT NULL,
  "row" INTEGER NOT NULL,
  min_x_m REAL NOT NULL,
  min_y_m REAL NOT NULL,
  max_x_m REAL NOT NULL,
  max_y_m REAL NOT NULL,
  center_lon_deg REAL NOT NULL,
  center_lat_deg REAL NOT NULL,
  east_per_x REAL NOT NULL,
  east_per_y REAL NOT NULL,
  north_per_x REAL NOT NULL,
  north_per_y REAL NOT NULL)sql";
  sql += column_list(tile_columns) + R"sql();
CREATE VIRTUAL TABLE rtree_tiles_geom USING rtree(id, minx, maxx, miny, maxy);
CREATE VIRTUAL TABLE pilotage_tile_centers USING rtree(tile_id, min_lon, max_lon, min_lat, max_lat);
CREATE TABLE pilotage_descriptors (
  id INTEGER PRIMARY KEY NOT NULL,
  tile_id INTEGER NOT NULL,
  level INTEGER NOT NULL,
  window_col_px INTEGER NOT NULL,
  window_row_px INTEGER NOT NULL,
  window_width_px INTEGER NOT NULL,
  window_height_px INTEGER NOT NULL,
  count INTEGER NOT NULL,
  descriptor_bytes INTEGER NOT NULL,
  ground_base_m REAL,
  digest BLOB NOT NULL,
  keypoints BLOB NOT NULL,
  descriptors BLOB NOT NULL,
  UNIQUE (tile_id, level));
)sql";
  if (chips) {
    sql += R"sql(
CREATE TABLE pilotage_chips (
  id INTEGER PRIMARY KEY NOT NULL,
  tile_id INTEGER NOT NULL,
  level INTEGER NOT NULL,
  window_col_px INTEGER NOT NULL,
  window_row_px INTEGER NOT NULL,
  window_width_px INTEGER NOT NULL,
  window_height_px INTEGER NOT NULL,
  encoding TEXT NOT NULL,
  digest BLOB NOT NULL,
  data BLOB NOT NULL,
  UNIQUE (tile_id, level));
)sql";
  }
  return sql;
}

std::string create_landmark_tables() {
  return R"sql(
CREATE TABLE pilotage_detectors (
  id INTEGER PRIMARY KEY NOT NULL,
  class TEXT NOT NULL UNIQUE,
  gsd_m REAL NOT NULL,
  window_px INTEGER NOT NULL,
  cell_px INTEGER NOT NULL,
  levels INTEGER NOT NULL,
  context REAL NOT NULL,
  offset_x REAL NOT NULL,
  offset_y REAL NOT NULL,
  period_deg REAL NOT NULL,
  threshold REAL NOT NULL,
  shortest_m REAL NOT NULL,
  longest_m REAL NOT NULL,
  p_detect REAL NOT NULL,
  false_alarms_per_km2 REAL NOT NULL,
  sigma_m REAL NOT NULL,
  filters BLOB NOT NULL);
CREATE TABLE landmarks (
  fid INTEGER PRIMARY KEY NOT NULL,
  geom POINT NOT NULL,
  detector INTEGER NOT NULL,
  lon_deg REAL NOT NULL,
  lat_deg REAL NOT NULL,
  length_m REAL NOT NULL,
  ground_height_m REAL,
  found INTEGER NOT NULL,
  ambiguity REAL);
)sql";
}

std::string create_line_table(const std::string& table, const std::string& geometry_type,
                              const std::vector<MapColumn>& columns) {
  return "CREATE TABLE " + table + " (fid INTEGER PRIMARY KEY NOT NULL, geom " + geometry_type + " NOT NULL" +
         column_list(columns) + ");";
}

// OGC 12-128r17 (GeoPackage 1.3), Annex F.3, with the names of our table and columns.
std::string create_rtree_triggers() {
  const std::string box = "NEW.tile_id, ST_MinX(NEW.geom), ST_MaxX(NEW.geom), ST_MinY(NEW.geom), ST_MaxY(NEW.geom)";
  const std::string put = "INSERT OR REPLACE INTO rtree_tiles_geom VALUES (" + box + ");";
  const std::string filled = "(NEW.geom NOTNULL AND NOT ST_IsEmpty(NEW.geom))";
  const std::string empty = "(NEW.geom ISNULL OR ST_IsEmpty(NEW.geom))";
  const std::string remove = "DELETE FROM rtree_tiles_geom WHERE id = OLD.tile_id;";
  return "CREATE TRIGGER rtree_tiles_geom_insert AFTER INSERT ON tiles WHEN " + filled + " BEGIN " + put + " END;\n" +
         "CREATE TRIGGER rtree_tiles_geom_update1 AFTER UPDATE OF geom ON tiles WHEN OLD.tile_id = NEW.tile_id AND " +
         filled + " BEGIN " + put + " END;\n" +
         "CREATE TRIGGER rtree_tiles_geom_update2 AFTER UPDATE OF geom ON tiles WHEN OLD.tile_id = NEW.tile_id AND " +
         empty + " BEGIN " + remove + " END;\n" +
         "CREATE TRIGGER rtree_tiles_geom_update3 AFTER UPDATE ON tiles WHEN OLD.tile_id != NEW.tile_id AND " + filled +
         " BEGIN " + remove + " " + put + " END;\n" +
         "CREATE TRIGGER rtree_tiles_geom_update4 AFTER UPDATE ON tiles WHEN OLD.tile_id != NEW.tile_id AND " + empty +
         " BEGIN DELETE FROM rtree_tiles_geom WHERE id IN (OLD.tile_id, NEW.tile_id); END;\n" +
         "CREATE TRIGGER rtree_tiles_geom_delete AFTER DELETE ON tiles WHEN OLD.geom NOT NULL BEGIN " + remove +
         " END;\n";
}

MapDeclarations read_declarations(const Database& database) {
  MapDeclarations declared;
  Statement statement = database.prepare("SELECT type, name, sql, tbl_name FROM sqlite_master", "schema");
  std::size_t rows = 0;
  while (statement.step()) {
    std::string name(statement.text(1));
    static_cast<void>(statement.text(3));  // counts its bytes
    if (++rows > kMaxDeclarations || declared.contains(name)) {
      throw DataError(database.name() + ": declares " +
                      (declared.contains(name) ? name + " twice" : "more than a map has"));
    }
    const bool own_index = statement.text(0) == "index" && statement.is_null(2);
    if (own_index) continue;
    declared.emplace(std::move(name), statement.text(2));
  }
  return declared;
}

void check_declaration(const MapDeclarations& declared, std::string_view table, const std::string& file) {
  const auto found = declared.find(table);
  const bool rtree = table == kGridIndex || table == kCenterIndex;
  if (found == declared.end() || found->second.starts_with("CREATE VIEW")) {
    throw DataError(file + ": has no " + (rtree ? "R-tree " : "table ") + std::string(table));
  }
  if (is_as_written(table, found->second)) return;
  throw DataError(file + ": " + std::string(table) + " is not declared as a map declares it; it is not read");
}

void check_declarations(const MapDeclarations& declared, const std::string& file) {
  for (const auto* forms : {&written().whole, &written().layers}) {
    for (auto form = forms->begin(); form != forms->end(); form = forms->upper_bound(form->first)) {
      const bool may_be_absent = form->first == "pilotage_chips" || form->first == "pilotage_detectors" ||
                                 form->first == "landmarks" || form->second.starts_with("CREATE TRIGGER");
      if (!may_be_absent || declared.contains(form->first)) check_declaration(declared, form->first, file);
    }
  }
  for (const auto& [name, sql] : declared) {
    if (written().whole.contains(name) || written().layers.contains(name)) continue;
    throw DataError(file + ": declares " + name +
                    ", which no map has: another program changed the file, or it is of a newer one");
  }
  if (declared.contains("landmarks") != declared.contains("pilotage_detectors")) {
    throw DataError(file + ": declares landmarks without detectors, or detectors without landmarks");
  }
}

std::string sql_type(MapColumnType type) {
  switch (type) {
    case MapColumnType::kInteger:
      return "INTEGER";
    case MapColumnType::kText:
      return "TEXT";
    case MapColumnType::kReal:
      break;
  }
  return "REAL";
}

void check_columns(const std::string& table, const std::vector<MapColumn>& columns) {
  if (columns.size() > kMaxColumns) {
    throw UsageError(table + ": has " + std::to_string(columns.size()) + " columns, at most " +
                     std::to_string(kMaxColumns) + " are allowed");
  }
  std::set<std::string> names;
  for (const MapColumn& column : columns) {
    const std::string where = table + ": column \"" + column.name + "\"";
    if (!good_name(column.name)) throw UsageError(where + ": a name is at most 60 of a-z, 0-9, _ and no digit first");
    if (reserved_name(column.name)) throw UsageError(where + ": the name is one that every map has already");
    if (!names.insert(column.name).second) throw UsageError(where + ": is given twice");
    check_text(where, column.description);
  }
}

void check_text(const std::string& where, const std::string& text) {
  if (text.size() > static_cast<std::size_t>(kMaxMapBlobBytes) / 2) {
    throw UsageError(where + ": the text has " + std::to_string(text.size()) + " bytes, too many for a map");
  }
  std::string_view rest = text;
  while (!rest.empty()) {
    const std::size_t length = rest[0] == '\0' ? 0 : utf8_sequence_length(rest);
    if (length == 0) throw UsageError(where + ": the text is not UTF-8 without NUL");
    rest.remove_prefix(length);
  }
}

}  // namespace pilotage
