#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pilotage/mapdb/map_types.h"
#include "pilotage/mapdb/sqlite.h"

namespace pilotage {

// The rows of GeoPackage's own tables (OGC 12-128r17).

/// SOURCE_DATE_EPOCH (https://reproducible-builds.org/specs/source-date-epoch) or 1970-01-01, as GeoPackage writes
/// dates. Throws UsageError when the variable is not a number of seconds.
std::string geopackage_timestamp();

/// WKT 2 begins with another keyword than WKT 1 (OGC 18-010r11, clause 7.2.2).
bool is_wkt2(std::string_view wkt);

/// The srs_id of a grid's CRS: the code of its authority where that may serve, else 100000.
std::int64_t srs_id_of(const MapCrs& crs);

/// "INSERT INTO table VALUES (?, …)" with `count` values.
std::string insert_sql(std::string_view table, int count);

/// Fills gpkg_spatial_ref_sys: the three rows that GeoPackage prescribes, and the grid's CRS.
void insert_spatial_reference_systems(const Database& database, const MapCrs& crs);

/// Fills gpkg_extensions.
void insert_extensions(const Database& database, bool wkt2, bool chips, bool landmarks);

/// Adds to gpkg_data_columns what the columns of a layer mean.
void insert_column_descriptions(const Database& database, std::string_view table,
                                const std::vector<MapColumn>& columns);

}  // namespace pilotage
