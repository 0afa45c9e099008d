#pragma once

#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/raster.h"

namespace pilotage {

/// Writes a raster of one channel of 8 bits as PNG, and its place beside it as PATH.aux.xml, where GDAL, QGIS and
/// inspect_imagery() find it; the mask is not written. The same raster gives the same bytes. Throws UsageError for a
/// raster of another type, DataError when it cannot be written.
void write_gray8_png(const std::filesystem::path& path, const Raster& raster, const Crs& crs);

}  // namespace pilotage
