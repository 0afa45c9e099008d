#pragma once

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// Means of reduction × reduction pixels; columns and rows beyond the last whole one are dropped. For pictures of at
/// least so many pixels.
cv::Mat reduced_picture(const cv::Mat& pixels, int reduction);

/// What is valid in all of them: CV_8UC1, 0 or 255, of such a mask.
cv::Mat reduced_mask(const cv::Mat& valid, int reduction);

}  // namespace pilotage
