#pragma once

#include <opencv2/core/mat.hpp>

#include "pilotage/base/random.h"

namespace pilotage {

/// Random fields and small filters that degraded copies are made of; CV_32F, size_px × size_px where no size is said.

/// Independent standard normal values, row by row.
cv::Mat white_field(cv::Size size, Random random);

/// Gaussian blur whose kernel ends at 2.5 sigma (1.2 % of the weight is cut off), mirrored at the borders.
void blur(const cv::Mat& from, cv::Mat& to, double sigma_px);

/// Local standard deviation of a texture of mean 0, over about four times `sigma_px`. It varies slowly and is computed
/// on a grid four times coarser.
cv::Mat local_strength(const cv::Mat& fine, double sigma_px);

/// What is finer than `sigma_px` in white noise, mean 0 and unit variance.
cv::Mat texture_field(int size_px, double sigma_px, const Random& random);

/// 1 + amplitude · one slow wave of random direction and phase, half to one and a half periods across.
cv::Mat wave_field(int size_px, double amplitude, Random random);

}  // namespace pilotage
