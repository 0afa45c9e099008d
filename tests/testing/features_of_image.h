#pragma once

#include <opencv2/core/mat.hpp>

#include "pilotage/vision/features.h"

namespace pilotage::testing {

/// Features of one image as a map of that size has them; `valid` (CV_8UC1, 0 = no data) empty: all is valid. An image
/// of up to kFeatureBlockPx each way is one block.
inline FeatureSet features_of_image(const cv::Mat& gray, const FeatureOptions& options, const cv::Mat& valid = {}) {
  const cv::Mat mask = valid.empty() ? cv::Mat(gray.size(), CV_8UC1, cv::Scalar(255)) : valid;
  return extract_features_of_map(gray_source_from({gray, mask, {}}), {{0, 0, gray.cols, gray.rows}}, options, 1);
}

}  // namespace pilotage::testing
