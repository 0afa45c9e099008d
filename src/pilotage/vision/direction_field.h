#pragma once

#include <opencv2/core/mat.hpp>

namespace pilotage {

// Along which lines a picture changes, not how: z = w·e^{2iθ} for each pixel, θ the direction of the gradient and
// w = |∇|/(|∇| + the median of |∇|). Doubling the angle makes both sides of a line say the same (G. Granlund, "In
// search of a general picture processing operator", Computer Graphics and Image Processing 8, 1978): light and shade
// may change places between two dates. θ is counted from along the rows (columns growing) to along the columns (rows
// growing).

/// Of the Gaussian before the gradient, in pixels.
inline constexpr double kDirectionSigmaPx = 0.7;
/// A pixel's direction depends on the pixels within this distance along rows and columns, and on no others.
inline constexpr int kDirectionReachPx = 3;
/// Gray values per pixel: a picture whose median gradient is less is taken to be even, and what changes less to be
/// noise.
inline constexpr double kFaintGradient = 0.5;

struct DirectionField {
  cv::Mat z;      ///< CV_32FC2: (w·cos 2θ, w·sin 2θ), 0 where not valid.
  cv::Mat valid;  ///< CV_8UC1: 255 where all pixels within kDirectionReachPx are valid and in the picture, else 0.
};

/// `gray` and `valid` (0 = not valid) are CV_8UC1 of one size. The median is over the field's valid pixels.
DirectionField direction_field(const cv::Mat& gray, const cv::Mat& valid);

/// The field in steps, CV_8UC1: 0 where w ≤ ½, that is where the picture changes less than at half of its pixels; else
/// 1 + k, where 2θ lies in [k, k + 1)·2π/kDirectionSectors.
cv::Mat direction_steps(const cv::Mat& z);

/// CV_32FC2 of length 1 in the middle of its sector; 0 at steps of 0. Steps are at most kDirectionSectors.
cv::Mat field_from_steps(const cv::Mat& steps);

inline constexpr int kDirectionSectors = 8;

}  // namespace pilotage
