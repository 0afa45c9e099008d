#pragma once

#include <cstdint>

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// A piece of an image at a coarser scale, on a grid that starts at the outer corner of the whole image: pixel (i, j)
/// of the octave is the mean of the ground between (i, j)·scale and (i + 1, j + 1)·scale of the image.
struct Octave {
  double scale = 1;
  std::int64_t first_col = 0;  ///< Of the pixels below, in the octave's grid.
  std::int64_t first_row = 0;
  cv::Mat gray;   ///< CV_8UC1; may be empty.
  cv::Mat valid;  ///< CV_8UC1: 255 where all pixels averaged are valid. Empty: all valid.
};

/// The octave of the piece `gray` (with `valid`, or empty for all valid) whose first pixel is (`first_col`,
/// `first_row`) of the whole image: all octave pixels that lie wholly inside the piece. Each depends only on the pixels
/// it covers and on its place, never on how the image was cut into pieces. scale ≥ 1; 1 shares the pixels.
Octave make_octave(const cv::Mat& gray, const cv::Mat& valid, std::int64_t first_col, std::int64_t first_row,
                   double scale);

}  // namespace pilotage
