#pragma once

#include <vector>

#include "pilotage/geo/bounds.h"
#include "pilotage/geo/geo_transform.h"
#include "pilotage/raster/gdal_write.h"
#include "pilotage/registration/warp_field.h"

namespace pilotage {

/// The disagreement of two georeferences as a layer: bands east_m, north_m, magnitude_m (where the second date shows
/// the ground, minus where the reference shows it) and sigma_m (per axis), CV_32F, NaN where it is not known.
struct DisagreementRaster {
  std::vector<ScoreBand> bands;
  GeoTransform map_from_pixel;
};

/// The field over `area_m` in pixels of the field's cells.
DisagreementRaster disagreement_raster(const WarpField& field, const Bounds& area_m);

}  // namespace pilotage
