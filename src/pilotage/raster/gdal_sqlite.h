#pragma once

#include <string>
#include <string_view>

// Private to raster/gdal_*.cc and route/ogr_*.cc: SQLite files (GeoPackage, MBTiles) of strangers, before GDAL opens
// them, which sets no limits.

namespace pilotage {

/// Of a raster dataset, also of one inside a file ("GPKG:all.gpkg:table"): reads what GDAL reads whole when it opens
/// it, the tables that describe the others, with SQLite's steps counted. Throws DataError beginning with `dataset` when
/// that takes more than a file of its size can need, as where pages are read in circles, when a value is longer than
/// the file, and when a table has generated columns, whose formulas would run for each row. What is no SQLite file, or
/// cannot be read as one, is left to GDAL.
void check_sqlite_raster(const std::string& dataset);

/// The same of a file of vectors in memory, called `name`; views are refused, too, since features would come from them.
void check_sqlite_vectors(const std::string& name, std::string_view bytes);

}  // namespace pilotage
