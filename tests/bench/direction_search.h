#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/match/checkpoint.h"
#include "pilotage/match/chip_mosaic.h"

namespace pilotage {

// Where a frame lies on the map's chips by the directions of its edges, part by part: these stay from one season, or
// sensor, to another more often than gray values do. A study, not what flies: docs/decisions/directions.md.

/// What is compared of each pixel: how much of the gradient points into each of eight directions, less what it has of
/// all, as a vector of at most unit length (cells of histograms of oriented gradients: N. Dalal, B. Triggs, CVPR 2005);
/// then its local contrast at two widths; each less its surroundings. Ten CV_32FC1; 0 where not valid, and beside.
std::vector<cv::Mat> direction_field(const cv::Mat& gray, const cv::Mat& valid);

/// How well a frame agrees with the chips at every whole position of its nadir point in a window, in pixels of the
/// mosaic.
struct DirectionSurface {
  /// CV_32FC1: over the median of the window, in standard deviations of what the parts do elsewhere; kNotCompared where
  /// the frame shares too few pixels with the chips.
  cv::Mat agreement;
  cv::Point first;  ///< The position of its first pixel.

  static constexpr float kNotCompared = -100;

  /// The most within one pixel of a place of the nadir, in pixels of the mosaic; 0 outside the window.
  double at(const Eigen::Vector2d& nadir_px) const;
};

/// The frame is cut into 3 × 3 parts. Each is correlated with the chips over all that is compared, its surface may move
/// by two pixels at a price, and is divided by its own spread over the window, so that no road or roof rules; their sum
/// is N(0, 1) where nothing fits. Of the turns, in degrees clockwise, the best counts. `center_px` and `half_width_px`
/// as search_chips() has them; the spread is that of 58 pixels of the mosaic at least.
///
/// Never throws but std::bad_alloc and what `checkpoint` throws. Nothing where frame, mosaic or numbers are not usable
/// (search_chips), or no three parts show ground.
std::optional<DirectionSurface> search_directions(const RectifiedFrame& frame, const ChipMosaic& mosaic,
                                                  const Eigen::Vector2d& center_px, double half_width_px,
                                                  const std::vector<double>& turns_deg,
                                                  const Checkpoint& checkpoint = {});

/// The `count` highest places that are farther apart than `exclusion_px` along a row or a column, the highest first, in
/// pixels of the mosaic.
std::vector<Eigen::Vector2d> direction_places(const DirectionSurface& surface, std::size_t count, double exclusion_px);

}  // namespace pilotage
