#pragma once

// Everything a stage needs of GDAL and PROJ, wrapped once. Only src/pilotage/raster/gdal_*.cc (and route/ogr_*.cc for
// vector files) include GDAL. GDAL's errors become DataError with the dataset's name, and GDAL prints nothing.

#include "pilotage/raster/gdal_access.h"          // IWYU pragma: export
#include "pilotage/raster/gdal_config.h"          // IWYU pragma: export
#include "pilotage/raster/gdal_crs.h"             // IWYU pragma: export
#include "pilotage/raster/gdal_files.h"           // IWYU pragma: export
#include "pilotage/raster/gdal_geotiff.h"         // IWYU pragma: export
#include "pilotage/raster/gdal_gray.h"            // IWYU pragma: export
#include "pilotage/raster/gdal_image_metadata.h"  // IWYU pragma: export
#include "pilotage/raster/gdal_imagery.h"         // IWYU pragma: export
#include "pilotage/raster/gdal_vector.h"          // IWYU pragma: export
#include "pilotage/raster/gdal_write.h"           // IWYU pragma: export
