#pragma once

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// 1 where a mask is not 0, else 0: CV_32FC1.
cv::Mat mask_weight(const cv::Mat& valid);

}  // namespace pilotage
