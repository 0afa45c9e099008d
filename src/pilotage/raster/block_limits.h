#pragma once

#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {

/// Before any pixel is read: a part of the raster must be had without decoding too much of the rest. Throws DataError,
/// naming sizes and the remedy, when its blocks are larger than 512 MiB, or it is a JPEG or PNG of more than 2^30
/// pixels, which is decoded from its top for each part. `value_bytes`: of one pixel of one band.
void check_blocks(const ImageryInfo& info, int value_bytes);

}  // namespace pilotage
