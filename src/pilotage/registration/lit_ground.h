#pragma once

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// Which pixels are neither in a shadow nor at the edge of one: not darker than 0.7 of the mean of the ground within a
/// square of `window_px` around them, nor within two pixels of one that is. Dark things that are no shadows (tarred
/// roofs, water, crowns) go, too. `pixels` CV_32F, larger is lighter, from 0 up; `valid` CV_8U, not 0 where there is
/// ground. CV_8U, 255 or 0; a part of `valid`.
cv::Mat lit_ground(const cv::Mat& pixels, const cv::Mat& valid, int window_px);

}  // namespace pilotage
