#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>

#include "pilotage/vision/corner.h"

namespace pilotage {

/// What find_corners looks for.
struct CornerOptions {
  double corners_per_px = 0.02;
  int fast_threshold = 20;
  int min_fast_threshold = 5;
};

/// FAST corners inside `area` of `gray` (CV_8UC1), where `allowed` (CV_8UC1 of the same size, or empty) is not 0:
/// `area` is cut into cells of about eight corners; each keeps the strongest by Harris response (equal ones by y, then
/// x), and is searched again at min_fast_threshold when it has too few. `area` must keep 4 px of `gray` around it.
/// Order: y, then x.
std::vector<Corner> find_corners(const cv::Mat& gray, const cv::Mat& allowed, const cv::Rect& area,
                                 const CornerOptions& options);

/// Harris response of a pixel at least 4 px inside `gray`: det − 0.04 tr² of the structure tensor over 7 × 7 pixels,
/// Sobel derivatives of gray values in 0 … 1 with unit gain.
float harris_response(const cv::Mat& gray, int x, int y);

}  // namespace pilotage
