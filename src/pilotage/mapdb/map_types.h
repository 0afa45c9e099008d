#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "pilotage/geo/bounds.h"
#include "pilotage/geo/geodetic_point.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/vision/feature_set.h"

#pragma GCC visibility push(default)

namespace pilotage {

// What stands in the onboard map database, as values: MapWriter takes them, MapReader gives them back. The file format
// is specified in schemas/map-database.md and schemas/pilotage_descriptors.md.

/// The newest version of our schema; the file's own stands in map_info under "schema_version". A reader refuses a newer
/// one. A map without landmarks is of the first.
inline constexpr int kMapSchemaVersion = 2;
inline constexpr int kMapSchemaVersionWithoutLandmarks = 1;
/// Largest width and height of the window that one descriptor row or chip covers, in pixels of its level.
inline constexpr int kMaxMapWindowPx = 65536;
/// Largest number of descriptors of one row.
inline constexpr int kMaxMapDescriptors = 1 << 20;
/// Largest side of a chip's pixel in pixels of its level.
inline constexpr int kMaxChipFactor = 64;
/// Most pixels of one chip's picture: what a reader allocates for it is bounded by it.
inline constexpr std::int64_t kMaxChipPixels = std::int64_t{1} << 22;
/// Largest text or blob of one row, in bytes; a reader gives this limit to SQLite.
inline constexpr int kMaxMapBlobBytes = 1 << 26;
/// Most rows of map_info that are read: a mission of 20,000 rasters has as many.
inline constexpr std::size_t kMaxInfoEntries = 100'000;

/// The CRS of the mission grid; coordinates are x = easting, y = northing, in metres.
struct MapCrs {
  std::string name;       ///< For people, "WGS 84 / UTM zone 50S".
  std::string wkt;        ///< WKT 1 (OGC 01-009) or WKT 2 (OGC 12-063 / 18-010).
  std::string authority;  ///< "EPSG:32750", or "" when it has none.
};

/// One level of the map: its pixel grid and the heights above ground it serves.
struct MapLevel {
  TileMatrix
      matrix;        ///< matrix.level is the key; matrix.map_from_pixel goes from pixels of this level to the grid CRS.
  double gsd_m = 0;  ///< Side of a pixel on the ground.
  double min_agl_m = 0;
  double max_agl_m = 0;
  /// Largest distance from a tile's centre to its corner, metres on the ground. MapWriter computes it, whatever is
  /// given.
  double max_tile_radius_m = 0;
};

/// Where a tile lies. `enu_from_grid` lets the aircraft go between the grid and the ground without PROJ:
///   (east_m, north_m) = enu_from_grid · (point_grid − bounds.center_m()),
/// east and north on the WGS 84 tangent plane at `center` (LocalFrame(center)). It is the Jacobian of the projection at
/// the tile's centre; what is left out grows with the square of the distance d from the centre: for UTM and UPS grids
/// at most 5 mm (UTM) or 7 mm (UPS) at d = 1 km (docs/methods/map-database.md).
struct MapTile {
  std::int64_t tile_id = 0;  ///< At least 0; unique over all levels.
  int level = 0;
  std::int64_t column = 0;
  std::int64_t row = 0;
  Bounds bounds;         ///< The footprint, in the grid CRS.
  GeodeticPoint center;  ///< Of bounds.center_m(); lon in [-180, 180].
  Eigen::Matrix2d enu_from_grid = Eigen::Matrix2d::Identity();
};

/// A tile and its distance from a point: 0 inside its footprint.
struct NearTile {
  MapTile tile;
  double distance_m = 0;
};

enum class MapColumnType { kInteger, kReal, kText };

/// A column that a stage adds to the layer tiles, route or legs.
struct MapColumn {
  std::string name;  ///< [a-z_][a-z0-9_]*, at most 60 characters, not one of the layer's own columns.
  MapColumnType type = MapColumnType::kReal;
  std::string description;  ///< With the unit; stored in gpkg_data_columns, where QGIS shows it.
};

/// The value of such a column. std::monostate is NULL; a NaN is stored as NULL.
using MapValue = std::variant<std::monostate, std::int64_t, double, std::string>;

/// A feature of the layers route and legs: a line through WGS 84 points. Neighbouring points are joined the short way
/// round; a line across the antimeridian is cut there when it is stored.
struct MapLine {
  std::int64_t id = 0;
  std::vector<GeodeticPoint> points;  ///< At least two.
  std::vector<MapValue> values;       ///< One per column.
};

/// A line of map_info.
struct MapInfoEntry {
  std::string key;
  std::string value;
  bool operator==(const MapInfoEntry&) const = default;
};

/// The descriptors of one tile at one level. Features are relative to the window's outer top-left corner, so that
///   point_grid = matrix.map_from_pixel.map_from_pixel({window.col + x_px, window.row + y_px}).
/// Stored: x and y in 1/16 px, height in 0.1 m, octave exactly; the response is not.
struct TileDescriptors {
  std::int64_t tile_id = 0;
  int level = 0;        ///< Whose pixels `window` and the features are in.
  PixelWindow window;   ///< The cell whose descriptors these are: 0 ≤ x_px ≤ width, 0 ≤ y_px ≤ height.
  FeatureSet features;  ///< Of the pattern that map_info names.
  /// Height of the ground under each feature, metres above mean sea level, NaN where unknown. Empty when no height is
  /// known.
  std::vector<float> ground_height_m;
};

/// A small gray picture of one tile at one level, for matching by correlation.
struct MapChip {
  std::int64_t tile_id = 0;
  int level = 0;
  PixelWindow window;  ///< The ground that the picture covers, in pixels of the level.
  /// "gray8": one byte for each pixel of the window, row by row. "chip1+zstd": mapdb/chip_codec.h. Others are kept as
  /// they are.
  std::string encoding;
  std::vector<std::uint8_t> data;
};

}  // namespace pilotage

#pragma GCC visibility pop
