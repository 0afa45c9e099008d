#pragma once

#include <string>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/ground/measure_scale.h"
#include "pilotage/ground/score_table.h"

namespace pilotage {

/// What of a report is drawn in KML as pictures, and the pictures.
struct DegreeOverlay {
  std::string kml;                                            ///< Folders and overlays, to stand in a document.
  std::vector<std::pair<std::string, std::string>> pictures;  ///< File name and PNG.
};

/// A legend on the screen of everything that the KMZ of a report draws, with `flown` legs and stretches without a fix,
/// and heat maps of `shown`, level by level, for the reader to switch on: at first the classes of the layer "decision"
/// are seen. A picture covers at most 256 × 256 cells with 8 × 8 pixels each, so that edges of cells stay within an
/// eighth of a cell however long the route is. No heat map where no tile has a value. Throws DataError when a picture
/// has no place in WGS 84.
DegreeOverlay heat_overlay(const ScoreTable& table, const MeasureScale& shown, bool flown);

/// The heat map of a measure: values (CV_64F, NaN where there is none) in the colours of its scale, CV_8UC4 with red
/// first, transparent where there is no value.
cv::Mat heat_picture(const cv::Mat& values, const MeasureScale& scale);

}  // namespace pilotage
