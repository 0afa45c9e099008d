#include "pilotage/mapdb/map_reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

#include <Eigen/LU>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/mapdb/chunked_file.h"
#include "pilotage/mapdb/descriptor_row.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/mapdb/map_schema.h"
#include "pilotage/mapdb/map_tables.h"

namespace pilotage {
namespace {

constexpr double kMaxSearchRadius_m = 100000;

constexpr std::size_t kSqliteHeaderBytes = 100;  // of an SQLite file

std::uint32_t byte_at(std::string_view header, std::size_t at) {
  return static_cast<unsigned char>(header[at]);
}

std::uint32_t big_endian_32(std::string_view header, std::size_t at) {
  return (byte_at(header, at) << 24) | (byte_at(header, at + 1) << 16) | (byte_at(header, at + 2) << 8) |
         byte_at(header, at + 3);
}

/// `begin`: the file's bytes, at least kSqliteHeaderBytes when it has as many; `size`: how many it has. SQLite would
/// find a short file or a foreign one too, but later and with fewer words.
void check_header(const std::string& file, std::string_view begin, std::uintmax_t size) {
  constexpr std::string_view kMagic("SQLite format 3\0", 16);
  if (begin.size() < kSqliteHeaderBytes || !begin.starts_with(kMagic)) {
    throw DataError(file + ": is not a map database (its first bytes are not SQLite's)");
  }
  const std::uint32_t stored_page_size = byte_at(begin, 16) * 256 + byte_at(begin, 17);
  const std::uintmax_t page_size = stored_page_size == 1 ? 65536 : stored_page_size;
  const std::uintmax_t pages = big_endian_32(begin, 28);
  if (size != page_size * pages) {
    throw DataError(file + ": has " + std::to_string(size) + " bytes, its header says " + std::to_string(pages) +
                    " pages of " + std::to_string(page_size));
  }
  if (byte_at(begin, 18) != 1 || byte_at(begin, 19) != 1) {
    throw DataError(file + ": is in write-ahead mode: another program opened it for writing; use an untouched copy");
  }
  if (big_endian_32(begin, 68) != kGeoPackageId || big_endian_32(begin, 60) != kGeoPackageVersion) {
    throw DataError(file + ": is not a GeoPackage 1.3 (application_id or user_version differ)");
  }
}

/// Longitudes and latitudes that hold everything within a distance of a point; one or two boxes (antimeridian).
struct DegreeBox {
  double min_lon, max_lon, min_lat, max_lat;
};

std::vector<DegreeBox> boxes_around(GeodeticPoint point, double radius_m) {
  // A degree of latitude is never shorter than 110574 m, a degree of longitude at the equator is 111319 m long and
  // shrinks with the cosine of the latitude (faster on a sphere than on the ellipsoid). 1 % to spare, and 1e-6 degrees.
  const double lat_margin = radius_m * 1.01 / 110574 + 1e-6;
  const double min_lat = point.lat_deg - lat_margin;
  const double max_lat = point.lat_deg + lat_margin;
  const double pole_side_lat = std::max(std::abs(min_lat), std::abs(max_lat));
  const double lon_margin = pole_side_lat < 89.9999
                                ? radius_m * 1.01 / (111319 * std::cos(pole_side_lat * std::numbers::pi / 180)) + 1e-6
                                : 360;
  if (lon_margin >= 180) return {{-180, 180, min_lat, max_lat}};
  const double lon = wrap_lon_deg(point.lon_deg);
  std::vector<DegreeBox> boxes = {{lon - lon_margin, lon + lon_margin, min_lat, max_lat}};
  if (lon - lon_margin <= -180) boxes.push_back({lon - lon_margin + 360, 180, min_lat, max_lat});
  if (lon + lon_margin >= 180) boxes.push_back({-180, lon + lon_margin - 360, min_lat, max_lat});
  return boxes;
}

/// How far a point lies outside the rectangle `bounds`, along each axis of the grid; 0 inside.
Eigen::Vector2d outside(const Bounds& bounds, const Eigen::Vector2d& point_m) {
  const Eigen::Vector2d nearest(std::clamp(point_m.x(), bounds.min_x_m, bounds.max_x_m),
                                std::clamp(point_m.y(), bounds.min_y_m, bounds.max_y_m));
  return point_m - nearest;
}

double ground_distance_m(const MapTile& tile, GeodeticPoint point) {
  const Eigen::Vector2d east_north_m = LocalFrame(tile.center).enu_from_geodetic(point).head<2>();
  const Eigen::Vector2d point_m = tile.bounds.center_m() + tile.enu_from_grid.inverse() * east_north_m;
  return (tile.enu_from_grid * outside(tile.bounds, point_m)).norm();
}

void sort_nearest_first(std::vector<NearTile>& tiles) {
  std::sort(tiles.begin(), tiles.end(), [](const NearTile& a, const NearTile& b) {
    return std::pair(a.distance_m, a.tile.tile_id) < std::pair(b.distance_m, b.tile.tile_id);
  });
}

/// A statement that is made when it is first needed, for one question to the map: what that may cost begins anew.
Statement& prepared(std::optional<Statement>& statement, Database& database, const std::string& sql,
                    std::string_view subject) {
  database.renew_cost();
  if (!statement) {
    statement.emplace(database.prepare(sql, subject, subject == "tiles" ? kMinTileRowBytes : Database::kMinRowBytes));
  }
  return *statement;
}

std::string join_sql(std::initializer_list<std::string_view> parts) {
  std::string sql;
  for (const std::string_view part : parts) sql.append(part);
  return sql;
}

MapColumnType column_type(std::string_view declared) {
  if (declared == "INTEGER") return MapColumnType::kInteger;
  return declared == "TEXT" ? MapColumnType::kText : MapColumnType::kReal;
}

MapValue read_value(const Statement& statement, int column, MapColumnType type) {
  if (statement.is_null(column)) return std::monostate{};
  if (type == MapColumnType::kInteger) return statement.integer(column);
  if (type == MapColumnType::kReal) return statement.real(column);
  return std::string(statement.text(column));
}

/// The first column; nothing for NULL.
std::optional<double> read_map_sigma_m(const Statement& statement, const std::string& file) {
  const MapValue value = read_value(statement, 0, MapColumnType::kReal);
  if (std::holds_alternative<std::monostate>(value)) return std::nullopt;
  const double* sigma_m = std::get_if<double>(&value);
  if (sigma_m != nullptr && *sigma_m >= 0 && *sigma_m <= kLargestMapSigma_m) return *sigma_m;
  throw DataError(file + ": tiles: " + std::string(kMapSigmaColumn) + " is no number from 0 to " +
                  format_number(kLargestMapSigma_m));
}

}  // namespace

MapReader::MapReader(Database database, std::size_t cache_bytes) : database_(std::move(database)), cache_(cache_bytes) {
  const MapDeclarations declared = read_declarations(database_);
  check_declaration(declared, "map_info", name());
  read_entries();  // a map of tomorrow may declare other tables: its version is what it is judged by
  check_declarations(declared, name());
  has_chips_ = declared.contains("pilotage_chips");
  has_landmarks_ = declared.contains("landmarks");
  read_info();
  read_levels();
  read_tile_columns();
}

MapReader MapReader::open(const SignedMap& map, std::size_t cache_bytes) {
  std::string begin;
  if (map.bytes()) {
    begin = map.bytes()->substr(0, kSqliteHeaderBytes);
  } else if (map.size() > 0) {
    begin = map.chunks()->read_chunk(0);
  }
  check_header(map.name(), begin, map.size());
  return {map.open_database(), cache_bytes};
}

MapReader MapReader::open(const std::filesystem::path& path, const std::vector<std::string>& trusted_keys,
                          std::size_t cache_bytes) {
  return open(read_signed_map(path, trusted_keys), cache_bytes);
}

MapReader MapReader::open_unverified(const std::filesystem::path& path, std::size_t cache_bytes) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) throw DataError(path.string() + ": is a folder, not a map");
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw DataError(path.string() + ": cannot be read: " + error.message());
  std::string header(kSqliteHeaderBytes, '\0');
  std::ifstream stream(path, std::ios::binary);
  stream.read(header.data(), static_cast<std::streamsize>(header.size()));
  header.resize(static_cast<std::size_t>(stream.gcount()));
  check_header(path.string(), header, size);
  return {Database::open_untrusted(path, kMaxMapBlobBytes), cache_bytes};
}

void MapReader::read_entries() {
  Statement statement = database_.prepare("SELECT key, value FROM map_info ORDER BY id", "map_info");
  while (statement.step()) {
    if (info_.entries.size() == kMaxInfoEntries) {
      throw DataError(database_.name() + ": map_info has more than " + std::to_string(kMaxInfoEntries) + " rows");
    }
    info_.entries.push_back({std::string(statement.text(0)), std::string(statement.text(1))});
  }
  const std::string version = info_.find("schema_version").value_or("");
  const auto [end, error] = std::from_chars(version.data(), version.data() + version.size(), info_.schema_version);
  if (error != std::errc{} || end != version.data() + version.size() || info_.schema_version < 1) {
    throw DataError(database_.name() + ": map_info: schema_version is \"" + version + "\", expected a number from 1");
  }
  if (info_.schema_version > kMapSchemaVersion) {
    throw DataError(database_.name() + ": has schema version " + version + "; this program reads up to version " +
                    std::to_string(kMapSchemaVersion) + ". Use a newer program, or prepare the map again");
  }
}

void MapReader::read_info() {
  camera_ = camera_of_info(info_, database_.name());
  purpose_ = purpose_of_info(info_, database_.name());
  features_ = features_of_info(info_, database_.name());
  elevation_sigma_m_ = elevation_sigma_m_of_info(info_, database_.name());
  Statement statement = database_.prepare(
      "SELECT s.srs_name, s.organization, s.organization_coordsys_id, s.definition, s.srs_id FROM "
      "gpkg_geometry_columns g "
      "JOIN gpkg_spatial_ref_sys s ON s.srs_id = g.srs_id WHERE g.table_name = 'tiles'",
      "gpkg_spatial_ref_sys");
  if (!statement.step()) throw DataError(database_.name() + ": the layer tiles has no CRS");
  info_.crs.name = statement.text(0);
  info_.crs.wkt = statement.text(3);
  const std::string organization(statement.text(1));
  if (organization != "NONE") info_.crs.authority = organization + ":" + std::to_string(statement.integer(2));
  if (info_.crs.wkt != "undefined") return;
  Statement wkt2 =
      database_.prepare("SELECT definition_12_063 FROM gpkg_spatial_ref_sys WHERE srs_id = ?", "gpkg_spatial_ref_sys");
  wkt2.bind(1, statement.integer(4));
  if (wkt2.step()) info_.crs.wkt = wkt2.text(0);
}

void MapReader::read_levels() {
  Statement statement = database_.prepare(join_sql({"SELECT ", kLevelColumns, " FROM pilotage_levels ORDER BY level"}),
                                          "pilotage_levels");
  while (statement.step()) {
    if (levels_.size() == kMaxLevels) {
      throw DataError(database_.name() + ": pilotage_levels has more than " + std::to_string(kMaxLevels) + " rows");
    }
    levels_.push_back(read_level_row(statement, database_.name()));
  }
  if (levels_.empty()) throw DataError(database_.name() + ": pilotage_levels: has no row");
}

void MapReader::read_tile_columns() {
  Statement statement = database_.prepare(
      "SELECT p.name, p.type, ifnull(d.description, '') FROM pragma_table_info('tiles') p LEFT JOIN gpkg_data_columns "
      "d "
      "ON d.table_name = 'tiles' AND d.column_name = p.name",  // as they are declared: to sort takes memory uncounted
      "tiles");
  std::set<std::string, std::less<>> own(kOwnTileColumns.begin(), kOwnTileColumns.end());
  own.emplace("geom");
  while (statement.step()) {
    const std::string name(statement.text(0));
    if (own.contains(name)) continue;
    tile_columns_.push_back({name, column_type(statement.text(1)), std::string(statement.text(2))});
    has_map_sigma_ = has_map_sigma_ || name == kMapSigmaColumn;
  }
}

const MapLevel* MapReader::find_level(int level) const {
  const auto it = std::find_if(levels_.begin(), levels_.end(), [&](const auto& l) { return l.matrix.level == level; });
  return it == levels_.end() ? nullptr : &*it;
}

std::vector<NearTile> MapReader::tiles_near(GeodeticPoint point, double radius_m, std::optional<int> level) {
  if (!std::isfinite(point.lon_deg) || !(std::abs(point.lat_deg) <= 90)) {
    throw UsageError("point (lon " + format_number(point.lon_deg) + ", lat " + format_number(point.lat_deg) +
                     ") is not on Earth");
  }
  if (!(radius_m >= 0 && radius_m <= kMaxSearchRadius_m)) {
    throw UsageError("radius_m = " + format_number(radius_m) + " is outside [0, " + format_number(kMaxSearchRadius_m) +
                     "]");
  }
  double reach_m = 0;
  for (const MapLevel& l : levels_) {
    if (!level || l.matrix.level == *level) reach_m = std::max(reach_m, radius_m + l.max_tile_radius_m);
  }
  Statement& statement = prepared(near_geodetic_, database_,
                                  join_sql({"SELECT ", kSelectTileColumns, " FROM ", kCenterIndex,
                                            (" i CROSS JOIN tiles t ON t.tile_id = i.tile_id WHERE i.max_lon >= ?1 AND "
                                             "i.min_lon <= ?2 AND i.max_lat >= ?3 AND i.min_lat <= ?4")}),
                                  "tiles");
  std::vector<NearTile> result;
  for (const DegreeBox& box : boxes_around(point, reach_m)) {
    const StatementScope scope(statement);
    statement.bind(1, box.min_lon).bind(2, box.max_lon).bind(3, box.min_lat).bind(4, box.max_lat);
    while (statement.step()) {
      NearTile near{read_tile_row(statement, database_.name()), 0};
      if (level && near.tile.level != *level) continue;
      near.distance_m = ground_distance_m(near.tile, point);
      if (near.distance_m <= radius_m) result.push_back(near);
    }
  }
  sort_nearest_first(result);
  // A tile on the antimeridian may be found from both sides.
  const auto same = [](const NearTile& a, const NearTile& b) { return a.tile.tile_id == b.tile.tile_id; };
  result.erase(std::unique(result.begin(), result.end(), same), result.end());
  return result;
}

std::vector<NearTile> MapReader::tiles_near(const Eigen::Vector2d& point_m, double radius_m, std::optional<int> level) {
  if (!point_m.allFinite()) throw UsageError("the point is not finite");
  if (!(radius_m >= 0) || !std::isfinite(radius_m)) {
    throw UsageError("radius_m = " + format_number(radius_m) + " is not a finite number from 0");
  }
  Statement& statement = prepared(near_grid_, database_,
                                  join_sql({"SELECT ", kSelectTileColumns, " FROM ", kGridIndex,
                                            (" i CROSS JOIN tiles t ON t.tile_id = i.id WHERE i.maxx >= ?1 AND "
                                             "i.minx <= ?2 AND i.maxy >= ?3 AND i.miny <= ?4")}),
                                  "tiles");
  const StatementScope scope(statement);
  statement.bind(1, point_m.x() - radius_m).bind(2, point_m.x() + radius_m);
  statement.bind(3, point_m.y() - radius_m).bind(4, point_m.y() + radius_m);
  std::vector<NearTile> result;
  while (statement.step()) {
    NearTile near{read_tile_row(statement, database_.name()), 0};
    if (level && near.tile.level != *level) continue;
    near.distance_m = outside(near.tile.bounds, point_m).norm();
    if (near.distance_m <= radius_m) result.push_back(near);
  }
  sort_nearest_first(result);
  return result;
}

std::optional<MapTile> MapReader::tile(std::int64_t tile_id) {
  Statement& statement = prepared(
      tile_, database_, join_sql({"SELECT ", kSelectTileColumns, " FROM tiles t WHERE t.tile_id = ?"}), "tiles");
  const StatementScope scope(statement);
  statement.bind(1, tile_id);
  if (!statement.step()) return std::nullopt;
  return read_tile_row(statement, database_.name());
}

std::vector<MapTile> MapReader::tiles(std::optional<int> level) {
  database_.renew_cost();
  Statement statement = database_.prepare(join_sql({"SELECT ", kSelectTileColumns, " FROM tiles t ORDER BY t.tile_id"}),
                                          "tiles", kMinTileRowBytes);
  std::vector<MapTile> result;
  while (statement.step()) {
    const MapTile tile = read_tile_row(statement, database_.name());
    if (!level || tile.level == *level) result.push_back(tile);
  }
  return result;
}

std::optional<std::vector<MapValue>> MapReader::tile_values(std::int64_t tile_id) {
  std::string sql = "SELECT tile_id";
  for (const MapColumn& column : tile_columns_) {
    sql += ", \"";
    for (const char c : column.name) sql += c == '"' ? std::string("\"\"") : std::string(1, c);
    sql += '"';
  }
  Statement& statement = prepared(tile_values_, database_, sql + " FROM tiles WHERE tile_id = ?", "tiles");
  const StatementScope scope(statement);
  statement.bind(1, tile_id);
  if (!statement.step()) return std::nullopt;
  std::vector<MapValue> values;
  for (std::size_t i = 0; i < tile_columns_.size(); ++i) {
    values.push_back(read_value(statement, static_cast<int>(i) + 1, tile_columns_[i].type));
  }
  return values;
}

std::optional<double> MapReader::map_sigma_m(std::int64_t tile_id) {
  if (!has_map_sigma_) return std::nullopt;
  Statement& statement =
      prepared(map_sigma_, database_, join_sql({"SELECT ", kMapSigmaColumn, " FROM tiles WHERE tile_id = ?"}), "tiles");
  const StatementScope scope(statement);
  statement.bind(1, tile_id);
  if (!statement.step()) return std::nullopt;
  return read_map_sigma_m(statement, database_.name());
}

std::optional<double> MapReader::largest_map_sigma_m() {
  if (!has_map_sigma_) return std::nullopt;
  database_.renew_cost();
  Statement statement =
      database_.prepare(join_sql({"SELECT ", kMapSigmaColumn, " FROM tiles t ORDER BY t.tile_id"}), "tiles");
  std::optional<double> largest_m;
  while (statement.step()) {
    const std::optional<double> sigma_m = read_map_sigma_m(statement, database_.name());
    if (sigma_m) largest_m = std::max(largest_m.value_or(0), *sigma_m);
  }
  return largest_m;
}

std::shared_ptr<const TileDescriptors> MapReader::descriptors(std::int64_t tile_id, int level) {
  return cache_.get<TileDescriptors>(tile_id, level, [&]() -> std::optional<TileDescriptors> {
    Statement& statement = prepared(
        descriptors_, database_,
        join_sql({"SELECT ", kDescriptorColumns, " FROM pilotage_descriptors WHERE tile_id = ? AND level = ?"}),
        "pilotage_descriptors");
    const StatementScope scope(statement);
    statement.bind(1, tile_id).bind(2, std::int64_t{level});
    if (!statement.step()) return std::nullopt;
    const DescriptorRow row = read_descriptor_row(statement, database_.name());
    check_descriptor_length(row, info_, database_.name());
    return decode_descriptors(row, features_.pattern, database_.name());
  });
}

std::optional<MapChip> MapReader::chip(std::int64_t tile_id, int level) {
  if (!has_chips_) return std::nullopt;
  Statement& statement = prepared(
      chip_, database_, join_sql({"SELECT ", kChipColumns, " FROM pilotage_chips WHERE tile_id = ? AND level = ?"}),
      "pilotage_chips");
  const StatementScope scope(statement);
  statement.bind(1, tile_id).bind(2, std::int64_t{level});
  if (!statement.step()) return std::nullopt;
  return read_chip_row(statement, database_.name());
}

std::shared_ptr<const MapLandmarks> MapReader::landmarks() {
  if (has_landmarks_ && !landmarks_) {
    database_.renew_cost();
    landmarks_ = std::make_shared<const MapLandmarks>(read_landmarks(database_));
  }
  return landmarks_;
}

std::shared_ptr<const DecodedChip> MapReader::decoded_chip(std::int64_t tile_id, int level) {
  return cache_.get<DecodedChip>(tile_id, level, [&]() -> std::optional<DecodedChip> {
    const std::optional<MapChip> stored = chip(tile_id, level);
    if (!stored) return std::nullopt;
    return DecodedChip{stored->window, decode_chip(*stored, database_.name())};
  });
}

}  // namespace pilotage
