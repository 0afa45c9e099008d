#include "pilotage/vision/mask_weight.h"

#include <opencv2/core.hpp>

namespace pilotage {

cv::Mat mask_weight(const cv::Mat& valid) {
  cv::Mat weight;
  cv::Mat(valid != 0).convertTo(weight, CV_32F, 1.0 / 255);
  return weight;
}

}  // namespace pilotage
