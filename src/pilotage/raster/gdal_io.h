#pragma once

#include <string>
#include <vector>

#include "pilotage/raster/gdal_crs.h"      // IWYU pragma: export
#include "pilotage/raster/gdal_gray.h"     // IWYU pragma: export
#include "pilotage/raster/gdal_imagery.h"  // IWYU pragma: export
#include "pilotage/raster/gdal_write.h"    // IWYU pragma: export

// Everything a stage needs of GDAL and PROJ, wrapped once. Only src/pilotage/raster/gdal_*.cc (and route/ogr_*.cc for
// vector files) include GDAL. GDAL's errors become DataError with the dataset's name, and GDAL prints nothing.

namespace pilotage {

/// Passes GDAL configuration options through ("GDAL_HTTP_TIMEOUT=30"), for the whole process. Call it before other
/// work. Throws UsageError for a text that is not KEY=VALUE.
void set_gdal_config(const std::vector<std::string>& key_values);

}  // namespace pilotage
