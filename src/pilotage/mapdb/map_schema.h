#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/mapdb/map_types.h"
#include "pilotage/mapdb/sqlite.h"

namespace pilotage {

// The SQL that makes the tables of a map (schemas/map-database.md).

/// GeoPackage's own tables; `with_wkt2` adds the column of the gpkg_crs_wkt extension.
std::string create_geopackage_tables(bool with_wkt2);

/// tiles with its columns and both R-trees, map_info, and our extension tables.
std::string create_map_tables(const std::vector<MapColumn>& tile_columns, bool chips);

/// pilotage_detectors and the layer landmarks.
std::string create_landmark_tables();

/// The layer route or legs.
std::string create_line_table(const std::string& table, const std::string& geometry_type,
                              const std::vector<MapColumn>& columns);

/// The triggers that GeoPackage wants beside the R-tree of tiles. They call functions that only a GIS has, so that they
/// are made when all tiles are in.
std::string create_rtree_triggers();

/// Name and SQL of every table, view, index and trigger that a file declares, but the indices that SQLite makes itself.
using MapDeclarations = std::map<std::string, std::string, std::less<>>;

/// Reads them; nothing of the file's own is run for it. Throws DataError, also when there are more than a map has.
MapDeclarations read_declarations(const Database& database);

/// Throws DataError, beginning with `file`, unless `declared` has this table exactly as this program writes it: nothing
/// that it holds may be computed (generated columns, checks, expressions), for one value may then cost hours.
void check_declaration(const MapDeclarations& declared, std::string_view table, const std::string& file);

/// The same of all that a map has, of which pilotage_chips, the tables of landmarks and the triggers may be absent;
/// nothing else may be there.
void check_declarations(const MapDeclarations& declared, const std::string& file);

/// The SQL type of a column.
std::string sql_type(MapColumnType type);

/// Throws UsageError when a column's name or description may not be used in `table`.
void check_columns(const std::string& table, const std::vector<MapColumn>& columns);

/// Throws UsageError, beginning with `where`, when `text` is not UTF-8, holds a NUL or is too long.
void check_text(const std::string& where, const std::string& text);

}  // namespace pilotage
