#pragma once

#include <opencv2/core/mat.hpp>

namespace pilotage {

/// Sums over any rectangle of a picture of one channel, each in constant time (F. Crow, "Summed-Area Tables for Texture
/// Mapping", SIGGRAPH 1984). Exact for whole numbers of up to 53 bits of sum; of CV_8U up to 2^31 / 255 px.
class RectangleSums {
 public:
  explicit RectangleSums(const cv::Mat& values);
  double at(const cv::Rect& rectangle) const;  ///< Inside the picture.

 private:
  double value(int row, int col) const;

  cv::Mat sums_;
};

/// CV_32S: the sum of the `side_px` × `side_px` pixels around each; what lies beyond the picture counts as 0. Of whole
/// numbers only: exact.
cv::Mat box_sum(const cv::Mat& values, int side_px);

}  // namespace pilotage
