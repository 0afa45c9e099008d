#pragma once

#include <opencv2/core/mat.hpp>

#include "pilotage/base/random.h"

namespace pilotage {

/// Random fields and small filters that degraded copies are made of; CV_32F, size_px × size_px.

/// Independent standard normal values, row by row.
cv::Mat white_field(int size_px, Random random);

/// Gaussian blur whose kernel ends at 2.5 sigma (1.2 % of the weight is cut off), mirrored at the borders.
void blur(const cv::Mat& from, cv::Mat& to, double sigma_px);

/// Local standard deviation of a texture of mean 0, over about four times `sigma_px`. It varies slowly and is computed
/// on a grid four times coarser.
cv::Mat local_strength(const cv::Mat& fine, double sigma_px);

/// Mean 0 and variance 1 (a flat field stays as it is).
cv::Mat normalised(const cv::Mat& field);

/// What is finer than `sigma_px` in noise whose amplitude falls with frequency to the power `slope` (0: white noise, no
/// transform is made), unit variance.
cv::Mat texture_field(int size_px, double sigma_px, double slope, const Random& random);

/// level · (1 + amplitude · one slow wave of random direction and phase), half to one and a half periods across.
cv::Mat wave_field(int size_px, double level, double amplitude, Random random);

/// Factor 1 − contrast in shadow, 1 in the light: the edge of one large shadow (a half plane, half of `share` of the
/// picture) and quadrilaterals with sides of a sixteenth to a quarter of the picture, all cast in one direction, until
/// `share` is covered. The last one may cover more: at most a sixteenth of the picture too much. Edges are Gaussian
/// with sigma `edge_px`.
cv::Mat shadow_field(int size_px, double contrast, double share, double edge_px, Random random);

}  // namespace pilotage
