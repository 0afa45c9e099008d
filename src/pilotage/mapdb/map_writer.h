#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/map_types.h"
#include "pilotage/mapdb/sqlite.h"

#pragma GCC visibility push(default)

namespace pilotage {

struct MapLandmarks;

/// What must be known before the first row is written.
struct MapHeader {
  MapCrs crs;
  std::vector<MapLevel> levels;         ///< Ascending, unique matrix.level.
  std::vector<MapColumn> tile_columns;  ///< Scores and status of a tile.
  std::string description;              ///< One sentence for people who open the file in a GIS.
  bool chips = false;                   ///< Make the optional table of chips,
  bool landmarks = false;               ///< and those of landmarks.
};

/// Writes an onboard map database: GeoPackage 1.3 as schemas/map-database.md says. A class because rows must come in
/// order and nothing may appear before everything is written: the file grows under a temporary name and finish()
/// renames it; a writer that dies before leaves nothing behind.
///
/// The same calls give the same bytes (with the same SQLite library). Dates in the file come from the environment
/// variable SOURCE_DATE_EPOCH, or are 1970-01-01 without it.
///
/// Wrong rows (order, ranges, non-finite places, wrong number of values) throw UsageError naming table and key; a disk
/// that is full or fails throws DataError. After an exception only the destructor may be called.
class MapWriter {
 public:
  /// Refuses an existing `path` unless `overwrite`.
  MapWriter(const std::filesystem::path& path, MapHeader header, bool overwrite);

  /// Tiles come in ascending tile_id; `values` has one value per tile column.
  void add_tile(const MapTile& tile, const std::vector<MapValue>& values);

  /// Rows come in ascending (tile_id, level); their tile has been added before.
  void add_descriptors(const TileDescriptors& descriptors);

  /// Only when the header asked for chips; rows come in ascending (tile_id, level); their tile has been added before.
  void add_chip(const MapChip& chip);

  /// Only when the header asked for landmarks, then once. Detectors count from 0, landmarks come in ascending id.
  void write_landmarks(const MapLandmarks& landmarks);

  /// The layers route and legs, each once at most; ids ascend. A layer that is not written stays empty.
  void write_route(const std::vector<MapColumn>& columns, const std::vector<MapLine>& lines);
  void write_legs(const std::vector<MapColumn>& columns, const std::vector<MapLine>& lines);

  /// Appends to map_info. Keys are unique; "schema_version" and "content_digest" are the writer's own.
  void add_info(const std::string& key, const std::string& value);

  /// Writes what remains, the digest over everything, and puts the file in its place. Returns the content digest (64
  /// hex digits, schemas/map-database.md "Digests").
  std::string finish();

 private:
  struct LineLayer {
    std::string name;
    bool written = false;
    std::string geometry_type;
    std::vector<MapColumn> columns;
    Bounds extent_deg;  // x = longitude, y = latitude
  };
  static LineLayer line_layer(const char* name) {
    LineLayer layer;
    layer.name = name;
    return layer;
  }
  struct StoredTile {
    std::int64_t tile_id;
    Bounds bounds;
  };

  void create_tables();
  MapLevel& level_of(int level, const std::string& where);
  void check_window(std::int64_t tile_id, int level, const PixelWindow& window, int slack_px, const std::string& where);
  void write_lines(LineLayer& layer, const std::vector<MapColumn>& columns, const std::vector<MapLine>& lines);
  void write_levels();
  void write_contents();

  MapHeader header_;  // its levels gather max_tile_radius_m
  OutputFile output_;
  Database database_;
  std::string timestamp_;
  std::int64_t srs_id_;
  Bounds tile_extent_;
  std::vector<StoredTile> tiles_;  // ascending tile_id
  std::optional<std::pair<std::int64_t, int>> last_descriptors_;
  std::optional<std::pair<std::int64_t, int>> last_chip_;
  std::set<std::string> info_keys_;
  bool landmarks_written_ = false;
  Bounds landmarks_extent_deg_;  // x = longitude, y = latitude
  LineLayer route_ = line_layer("route");
  LineLayer legs_ = line_layer("legs");
  std::optional<Statement> insert_tile_;
  std::optional<Statement> insert_box_;
  std::optional<Statement> insert_center_;
  std::optional<Statement> insert_descriptors_;
  std::optional<Statement> insert_chip_;
  std::optional<Statement> insert_info_;
  bool finished_ = false;
};

}  // namespace pilotage

#pragma GCC visibility pop
