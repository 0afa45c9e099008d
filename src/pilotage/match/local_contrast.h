#pragma once

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// Gray values as their surroundings see them: (g − mean)/sqrt(variance + kFaintVariance), mean and variance over the
/// valid pixels under a Gaussian of `sigma_px`, held to ±kMostContrast. So light and shade, haze and the brightness of
/// fields and water between two dates fall out, and what is left are edges and texture. CV_32FC1; 0 where not valid.
/// `gray` and `valid` are CV_8UC1 of one size; sigma_px > 0.
cv::Mat local_contrast(const cv::Mat& gray, const cv::Mat& valid, double sigma_px);

/// Gray values squared: surroundings fainter than 2 gray levels are not blown up to full contrast.
inline constexpr double kFaintVariance = 4;
inline constexpr double kMostContrast = 3;

}  // namespace pilotage
