#pragma once

#include <string>
#include <vector>

#pragma GCC visibility push(default)

namespace pilotage {

/// What rasters may make GDAL reach (docs/decisions/imagery-drivers.md). All of it is off unless the user asks for it,
/// because names of rasters come out of missions, plans and VRTs that others wrote.
struct RasterAccess {
  /// File systems that fetch (/vsicurl/, /vsis3/, …), web maps (WMS, WMTS, WCS) and grids that PROJ downloads.
  bool network = false;
  /// VRTs with raw bands, or with sources outside the folder of the VRT that was named.
  bool any_vrt = false;
  /// GDAL's short names of drivers that rasters may have besides those of raster_drivers(): "netCDF".
  std::vector<std::string> drivers;
};

/// Allows this much, and no more, from now on: for the whole process, because GDAL opens by itself what a file names.
/// GDAL's drivers and file systems that are not allowed are taken out of its lists; a program that uses GDAL besides
/// this library allows here what it needs itself. Without a call nothing but the defaults is allowed as soon as the
/// library first uses GDAL. Call it while no other thread uses GDAL. Throws UsageError for a driver that this GDAL does
/// not have.
void set_raster_access(const RasterAccess& access);

/// GDAL's short names of the drivers that open rasters without being asked for.
const std::vector<std::string>& raster_drivers();

}  // namespace pilotage

#pragma GCC visibility pop
