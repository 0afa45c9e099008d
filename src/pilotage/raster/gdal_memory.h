#pragma once

#include <string>

#include <gdal.h>
#include <opencv2/core/types.hpp>

#include "pilotage/geo/geo_transform.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/gdal_handle.h"

// Private to raster/gdal_*.cc.

namespace pilotage {

/// A raster in memory with its place. Throws DataError beginning with `name`.
DatasetPtr create_in_memory(const cv::Size& size, int bands, GDALDataType type, const Crs& crs,
                            const GeoTransform& place, const std::string& name);

}  // namespace pilotage
