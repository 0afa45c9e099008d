#pragma once

#include <optional>
#include <string>

#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_imagery.h"

// Private to raster/gdal_*.cc: rasters whose only georeference is ground control points.

namespace pilotage {

/// How the ground control points of a raster place it, where they alone do and no affine transform fits them; nothing
/// where it has a geotransform, no points, or points that are exactly an affine transform. The polynomial, of first or
/// second order, is the one that predicts better the points it was not fitted to: each point is left out of a fit once
/// (one by one, or of more than 20 points each twentieth together). `stand_in` is the CRS of points that state none.
/// Throws DataError, naming the dataset, for fewer than 4 points, points in a line, no CRS, and points that miss their
/// places by more than 5 pixels (rms).
std::optional<ControlPointFit> fit_control_points(GDALDataset& dataset, const std::string& name,
                                                  const std::string& stand_in);

/// The raster on the north-up grid of its points' CRS, transparent where it has no pixels. It reads `dataset`, which
/// must outlive it.
DatasetPtr place_by_control_points(GDALDataset& dataset, const std::string& name, const ControlPointFit& fit);

}  // namespace pilotage
