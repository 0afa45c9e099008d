#pragma once

#include <string>
#include <vector>

#include "pilotage/mapdb/map_types.h"

namespace pilotage {

// The SQL that makes the tables of a map (schemas/map-database.md).

/// GeoPackage's own tables; `with_wkt2` adds the column of the gpkg_crs_wkt extension.
std::string create_geopackage_tables(bool with_wkt2);

/// tiles with its columns and both R-trees, map_info, and our extension tables.
std::string create_map_tables(const std::vector<MapColumn>& tile_columns, bool chips);

/// The layer route or legs.
std::string create_line_table(const std::string& table, const std::string& geometry_type,
                              const std::vector<MapColumn>& columns);

/// The triggers that GeoPackage wants beside the R-tree of tiles. They call functions that only a GIS has, so that they
/// are made when all tiles are in.
std::string create_rtree_triggers();

/// The SQL type of a column.
std::string sql_type(MapColumnType type);

/// Throws UsageError when a column's name or description may not be used in `table`.
void check_columns(const std::string& table, const std::vector<MapColumn>& columns);

/// Throws UsageError, beginning with `where`, when `text` is not UTF-8, holds a NUL or is too long.
void check_text(const std::string& where, const std::string& text);

}  // namespace pilotage
