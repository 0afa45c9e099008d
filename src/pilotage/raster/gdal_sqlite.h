#pragma once

#include <string>
#include <string_view>

// Private to raster/gdal_*.cc and route/ogr_*.cc: SQLite files (GeoPackage, MBTiles) of strangers, before GDAL opens
// them, which sets no limits.

namespace pilotage {

/// Of a raster dataset, also of one inside a file ("GPKG:all.gpkg:table"): reads what GDAL reads whole when it opens
/// it, the tables that describe the others, with SQLite's steps and the bytes of the values counted. Throws DataError
/// beginning with `dataset` when that takes more than a file of its size can need, as where pages are read in circles;
/// when a value is longer than the file; when a table has generated columns, whose formulas would run for each row;
/// when a describing table is a view or a virtual one; when a view of tiles calls functions or itself, or cannot be
/// read; when SQLite cannot read it; and when the file lies packed in another one ("/vsizip/…"). What is no SQLite file
/// is left to GDAL.
void check_sqlite_raster(const std::string& dataset);

/// The same of a file of vectors in memory, called `name`. A view that is a layer by gpkg_contents is refused, too;
/// others are for the caller to leave alone (GDAL's open option LIST_ALL_TABLES=NO).
void check_sqlite_vectors(const std::string& name, std::string_view bytes);

}  // namespace pilotage
