#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "pilotage/mapdb/map_info.h"
#include "pilotage/mapdb/map_purpose.h"
#include "pilotage/mapdb/map_signature.h"
#include "pilotage/mapdb/map_types.h"
#include "pilotage/mapdb/sqlite.h"
#include "pilotage/mapdb/tile_cache.h"

#pragma GCC visibility push(default)

namespace pilotage {

struct MapLandmarks;

/// Some 800 tiles of 256 × 256 px with 20,000 features a megapixel and chips: the ground of a few hundred frames.
inline constexpr std::size_t kDefaultTileCacheBytes = std::size_t{64} << 20;

/// Reads an onboard map database (schemas/map-database.md) in flight: SQLite only, read-only, no locks, no writes
/// beside the file. Safe on any bytes: whatever the file holds, a function returns a value or throws DataError that
/// names file, table and tile, after a time and with memory that are bounded by the file's size (Database::renew_cost).
/// A file that declares anything else than a map does is not read at all. It does not compute digests.
///
/// What flies opens its map with keys, and nothing lies between check and use: either the file is read once, its
/// signature checked over these bytes, and SQLite reads these bytes and never the file again, which takes memory of the
/// file's size; or, of a large map that was signed with a list of its chunks, SQLite gets each piece of the file from a
/// chunk that was read whole and checked. A chunk that is not what was signed is an IntegrityError of whatever reads
/// it, so a map may also fail in flight; verify_map reads all of them before.
///
/// A reader keeps lately used tiles as decoded, which changes no result (mapdb/tile_cache.h).
///
/// One reader serves one thread at a time; several readers may open the same SignedMap, which they share, or the same
/// file, each with a cache of its own. A file that was opened unverified must not change while it is open.
class MapReader {
 public:
  /// Opens a map that one of the keys signed (read_signed_map), then checks size, format, version, tables, levels,
  /// camera, features. `cache_bytes` bounds the memory for decoded tiles; 0 decodes a tile each time. Throws
  /// UsageError, IntegrityError and DataError as read_signed_map does; DataError.
  static MapReader open(const std::filesystem::path& path, const std::vector<std::string>& trusted_keys,
                        std::size_t cache_bytes = kDefaultTileCacheBytes);

  /// The same of a map whose signature was checked before: for the readers of several threads. Throws DataError,
  /// IntegrityError.
  static MapReader open(const SignedMap& map, std::size_t cache_bytes = kDefaultTileCacheBytes);

  /// Opens whatever the file holds: nobody says who wrote it, or that its digests are right. For the ground, and for
  /// maps that verify_map has looked at. The file is read page by page as it is needed. Throws DataError.
  static MapReader open_unverified(const std::filesystem::path& path, std::size_t cache_bytes = kDefaultTileCacheBytes);

  const std::string& name() const { return database_.name(); }  ///< Of the file, as messages begin.

  /// Calls `checkpoint` every few hundred microseconds while the map is searched; what it throws comes out of the
  /// function that searches. An empty one ends that. match() sets its own for the time of the call.
  void watch(std::function<void()> checkpoint) { database_.watch(std::move(checkpoint)); }

  const MapInfo& info() const { return info_; }
  /// The camera that the map was prepared for; nothing when the map does not say.
  const std::optional<Camera>& camera() const { return camera_; }
  /// What the map is for; check_purpose holds it against what a flight asks for.
  const MapPurpose& purpose() const { return purpose_; }
  /// How its features are described, and so how a frame must be.
  const FeatureOptions& features() const { return features_; }
  /// Of the ground heights of its features; nothing when the map does not say.
  std::optional<double> elevation_sigma_m() const { return elevation_sigma_m_; }
  const std::vector<MapLevel>& levels() const { return levels_; }  ///< Ascending by level.
  const MapLevel* find_level(int level) const;                     ///< Or nullptr.

  /// Tiles (of one level, or of all) whose footprint comes within `radius_m` of a point on the ground, nearest first,
  /// ties by tile_id. Needs no projection library. Right to the linearisation of MapTile::enu_from_grid: millimetres at
  /// 1 km. Works across the antimeridian and at the poles. Throws UsageError unless the point is on Earth and radius_m
  /// in [0, 100000].
  std::vector<NearTile> tiles_near(GeodeticPoint point, double radius_m, std::optional<int> level = {});

  /// The same with a point in the grid CRS, and distances in the grid; `radius_m` may be any finite number ≥ 0.
  std::vector<NearTile> tiles_near(const Eigen::Vector2d& point_m, double radius_m, std::optional<int> level = {});

  /// The tile, or nothing when the map has none of that number.
  std::optional<MapTile> tile(std::int64_t tile_id);

  /// All tiles by ascending tile_id (of one level, or of all).
  std::vector<MapTile> tiles(std::optional<int> level = {});

  /// The columns that stages added to the layer tiles (scores, status), and their values for one tile in the same
  /// order; nothing when the map has no such tile.
  const std::vector<MapColumn>& tile_columns() const { return tile_columns_; }
  std::optional<std::vector<MapValue>> tile_values(std::int64_t tile_id);

  /// Standard deviation of where the map lies over a tile, each axis; nothing when the map does not say. Throws
  /// DataError for what is no number from 0 to 100.
  std::optional<double> map_sigma_m(std::int64_t tile_id);
  /// The largest of them, for NavigationOptions: then with a map_correlation_m of 1e6.
  std::optional<double> largest_map_sigma_m();

  /// Shared with the reader's cache; nullptr when the tile has no descriptors at that level.
  std::shared_ptr<const TileDescriptors> descriptors(std::int64_t tile_id, int level);

  /// Whether the map has a table of chips, and the chip of a tile, or nothing.
  bool has_chips() const { return has_chips_; }
  std::optional<MapChip> chip(std::int64_t tile_id, int level);

  /// The chip as pixels (mapdb/chip_codec.h), shared with the reader's cache; nullptr when there is none.
  std::shared_ptr<const DecodedChip> decoded_chip(std::int64_t tile_id, int level);

  /// Whether the map has tables of landmarks, and what they hold, read when it is first asked for: all of it, some 100
  /// bytes a landmark and 15 kB a filter. Nothing without the tables. Throws DataError.
  bool has_landmarks() const { return has_landmarks_; }
  std::shared_ptr<const MapLandmarks> landmarks();

 private:
  MapReader(Database database, std::size_t cache_bytes);
  void read_entries();
  void read_info();
  void read_levels();
  void read_tile_columns();

  Database database_;
  MapInfo info_;
  std::optional<Camera> camera_;
  MapPurpose purpose_;
  FeatureOptions features_;
  std::vector<MapLevel> levels_;
  std::vector<MapColumn> tile_columns_;
  std::optional<double> elevation_sigma_m_;
  bool has_map_sigma_ = false;
  bool has_chips_ = false;
  bool has_landmarks_ = false;
  std::shared_ptr<const MapLandmarks> landmarks_;
  TileCache cache_;
  // Prepared when first needed: parsing costs more than reading a tile.
  std::optional<Statement> near_geodetic_;
  std::optional<Statement> near_grid_;
  std::optional<Statement> tile_;
  std::optional<Statement> tile_values_;
  std::optional<Statement> map_sigma_;
  std::optional<Statement> descriptors_;
  std::optional<Statement> chip_;
};

}  // namespace pilotage

#pragma GCC visibility pop
