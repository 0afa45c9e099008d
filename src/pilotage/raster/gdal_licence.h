#pragma once

#include <gdal_priv.h>

#include "pilotage/raster/licence.h"

// Private to raster/gdal_*.cc.

namespace pilotage {

/// As read_licence, of a dataset that is open.
Licence find_licence(GDALDataset& dataset);

}  // namespace pilotage
