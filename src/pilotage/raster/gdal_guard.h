#pragma once

#include <string>
#include <vector>

// Private to raster/gdal_*.cc: what a raster may reach, as set_raster_access says.

namespace pilotage {

/// Applies the access once GDAL's drivers are registered. Called once, by GdalErrors.
void guard_gdal();

/// Before a raster is opened. Throws DataError, naming it and what would allow it, when its name leads off this
/// machine's files, when it is a pipe or a device (or one lies beside it, whose opening would wait for ever), or a VRT
/// that check_vrt refuses, or an SQLite file that check_sqlite_raster does.
void check_access(const std::string& dataset);

/// Throws DataError when the raster is of a driver that GDAL has and may not use.
void refuse_other_driver(const std::string& dataset);

/// Throws DataError when `dataset` is a VRT (also one inside another) that has a raw band or names what is no file
/// in the folder of the outermost VRT or below it, links resolved.
void check_vrt(const std::string& dataset);

/// Names of the pipes, devices and sockets in a folder.
std::vector<std::string> special_files_in(const std::string& folder);

/// Throws DataError when one of them, `special`, is the file, or has a name that begins like the file's own: GDAL opens
/// what lies beside a raster, and would wait there for ever.
void refuse_special_beside(const std::string& file, const std::vector<std::string>& special);

}  // namespace pilotage
