#pragma once

#include <cstddef>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/raster/raster.h"

namespace pilotage {

/// Where the corners of a row of pixels of a frame lie on the ground: from its pixels, centres at +0.5; NaN where a
/// corner sees none. One more than there are pixels.
struct CornerLine {
  std::vector<double> x_px;
  std::vector<double> y_px;
};

/// What a pixel of a frame shows of the ground under it: the mean over the quadrilateral between its corners, from
/// samples at most half a ground pixel apart, at least 2 × 2, unless that takes more than 256 × 256; a sample is
/// interpolated, where the frame is at least as fine as the ground by cubic convolution (R. Keys, IEEE Trans. ASSP 29,
/// 1981, a = −1/2), else linearly. None can be taken within a pixel and a half of the edges.
class SampledGround {
 public:
  /// `ground` is CV_8UC1. Its pixels are copied as floats, four bytes each; its mask is shared.
  explicit SampledGround(const Raster& ground);

  /// The means over the pixels between two lines of corners, of which `means` has one less; NaN where a corner is
  /// missing or a sample needs ground that is. Pixels that take equally many samples are worked out eight at a time:
  /// the same numbers, whatever stands beside a pixel.
  void means_between(const CornerLine& above, const CornerLine& below, std::vector<double>& means) const;

 private:
  cv::Mat pixels_;  // CV_32FC1
  cv::Mat valid_;   // empty where all are valid
};

}  // namespace pilotage
