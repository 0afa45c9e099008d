#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// The `count` highest places above 0 of a CV_32FC1 surface that are farther apart than `exclusion` along a row or a
/// column, the highest first.
std::vector<cv::Point> highest_places(const cv::Mat& surface, std::size_t count, int exclusion);

}  // namespace pilotage
