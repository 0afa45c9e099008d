#include "compare/texture.h"

#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"

namespace pilotage::testing {

cv::Mat texture(int width_px, int height_px, std::uint64_t seed) {
  cv::Mat sum(height_px, width_px, CV_32F, cv::Scalar(0));
  Random random(seed);
  for (const double sigma_px : {2.0, 4.0, 8.0, 16.0}) {
    cv::Mat noise(sum.size(), CV_32F);
    for (int row = 0; row < noise.rows; ++row) {
      for (int col = 0; col < noise.cols; ++col) noise.at<float>(row, col) = static_cast<float>(random.uniform(-1, 1));
    }
    cv::GaussianBlur(noise, noise, {}, sigma_px);
    sum += noise * sigma_px;
  }
  cv::Mat gray;
  cv::normalize(sum, gray, 0, 255, cv::NORM_MINMAX, CV_8U);
  return gray;
}

}  // namespace pilotage::testing
