#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "pilotage/mapdb/map_types.h"
#include "pilotage/mapdb/sqlite.h"

namespace pilotage {

// Names and rows that writer, reader and checks share. schemas/map-database.md is the specification.

inline constexpr std::int64_t kGeoPackageId = 0x47504B47;  // "GPKG"
inline constexpr std::int64_t kGeoPackageVersion = 10300;

/// The columns that every map has in the layer tiles, in this order, after geom; stages add theirs behind.
inline constexpr std::array<std::string_view, 14> kOwnTileColumns = {
    "tile_id", "level",          "column",         "row",        "min_x_m",    "min_y_m",     "max_x_m",
    "max_y_m", "center_lon_deg", "center_lat_deg", "east_per_x", "east_per_y", "north_per_x", "north_per_y",
};

/// Column of the layer tiles, where a stage adds it: standard deviation of where the map lies, each axis, in metres.
inline constexpr std::string_view kMapSigmaColumn = "map_sigma_m";
inline constexpr double kLargestMapSigma_m = 100;

/// `kOwnTileColumns` for a SELECT from a table called t.
inline constexpr std::string_view kSelectTileColumns =
    "t.tile_id, t.level, t.\"column\", t.\"row\", t.min_x_m, t.min_y_m, t.max_x_m, t.max_y_m, t.center_lon_deg, "
    "t.center_lat_deg, t.east_per_x, t.east_per_y, t.north_per_x, t.north_per_y";

/// The R-tree over the geometry of tiles, as the GeoPackage extension names it, and ours over their centres in degrees.
inline constexpr std::string_view kGridIndex = "rtree_tiles_geom";
inline constexpr std::string_view kCenterIndex = "pilotage_tile_centers";

/// What a row of tiles takes in the file at least: its outline alone.
inline constexpr int kMinTileRowBytes = 100;

/// The current row of a statement whose first columns are kSelectTileColumns. Throws DataError beginning with `file`.
MapTile read_tile_row(const Statement& statement, const std::string& file);

/// What is wrong with a tile (its bounds, centre or matrix), or "".
std::string tile_problem(const MapTile& tile);

/// The columns that read_level_row expects in a SELECT from pilotage_levels.
inline constexpr std::string_view kLevelColumns =
    "level, gsd_m, min_agl_m, max_agl_m, origin_x, x_per_col, x_per_row, origin_y, y_per_col, y_per_row, "
    "grid_width_px, "
    "grid_height_px, tile_size_px, stride_px, max_tile_radius_m";

/// The current row as a level; throws DataError beginning with `file`.
MapLevel read_level_row(const Statement& statement, const std::string& file);

/// What is wrong with a level, or "".
std::string level_problem(const MapLevel& level);

/// Distance on the ground from the centre of a tile to its farthest corner.
double tile_radius_m(const MapTile& tile);

}  // namespace pilotage
