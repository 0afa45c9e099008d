#pragma once

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// As far as a shadow's edge reaches into what it falls on.
inline constexpr int kLitEdge_px = 2;

/// Which pixels are neither in a shadow nor at the edge of one: not darker than 0.7 of the mean of the ground within a
/// square of `window_px` around them, nor within kLitEdge_px of one that is. Dark things that are no shadows (tarred
/// roofs, water, crowns) go, too; shadows in a picture whose black is far from 0 (haze, 16 bits with an offset) stay.
/// `pixels` CV_32F, larger is lighter, 0 is no light; where their mean is not positive all ground is lit. `valid`
/// CV_8U, not 0 where there is ground. CV_8U, 255 or 0; a part of `valid`.
cv::Mat lit_ground(const cv::Mat& pixels, const cv::Mat& valid, int window_px);

}  // namespace pilotage
