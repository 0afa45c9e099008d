#pragma once

#include <cstddef>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/match/chip_mosaic.h"
#include "pilotage/match/chip_templates.h"

namespace pilotage {

/// The field of a rectangle of the mosaic, which may reach beyond it, where nothing is valid.
struct ChipRegion {
  cv::Mat z;  ///< CV_32FC2
  cv::Mat valid;
};

ChipRegion cut_chip_region(const ChipMosaic& mosaic, const cv::Rect& rect);

/// A local maximum of the correlation.
struct ChipPeak {
  Eigen::Vector2d at_px{0, 0};  ///< Position of the nadir point in the mosaic, to a fraction of a pixel.
  double ncc = 0;               ///< At the whole position. 0 when nothing was compared.
  int pixels = 0;               ///< Compared there.
};

/// Climbs from position `start` of the nadir point to a higher neighbour until none is, at most `reach_px` along each
/// axis, by the zero-mean normalised correlation of MaskedCorrelation summed directly, in fields of 8 bits (its error
/// is below 0.01). Positions with less than `needed_px` common pixels are not compared. Where between the positions the
/// peak lies is told by parabolas.
ChipPeak climb(const ChipTemplates& templates, std::size_t index, const ChipMosaic& mosaic, const cv::Point& start,
               int reach_px, double needed_px);

}  // namespace pilotage
