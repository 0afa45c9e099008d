#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/base/progress.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/landmark/annotated_picture.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {

/// A chip of `pilotage landmark-label`, in memory.
struct TrainingChip {
  cv::Mat gray;  ///< CV_8U.
  std::vector<PictureLabel> labels;
  Bounds bounds_m;  ///< In the CRS of all chips.
};

/// The chips of several folders, of one ground.
struct TrainingChips {
  Crs crs;
  double gsd_m = 0;  ///< Of the grid of the chips of the first folder, in its CRS; others differ by at most 1 %.
  std::vector<TrainingChip> chips;
};

/// All chips of folders, each given once, that `pilotage landmark-label` wrote, by their labels.xml. Throws DataError
/// naming the folder: no annotations, chips that have no place, CRS or pixels unlike those of the first folder, a label
/// without class; Interrupted.
TrainingChips read_training_chips(const std::vector<std::string>& folders, const Progress& progress = {});

}  // namespace pilotage
