#include "pilotage/match/reduced_picture.h"

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pilotage {

cv::Mat reduced_picture(const cv::Mat& pixels, int reduction) {
  const cv::Size size(pixels.cols / reduction, pixels.rows / reduction);
  cv::Mat result;
  cv::resize(pixels(cv::Rect({0, 0}, size * reduction)), result, size, 0, 0, cv::INTER_AREA);
  return result;
}

cv::Mat reduced_mask(const cv::Mat& valid, int reduction) {
  return reduced_picture(valid, reduction) == 255;
}

}  // namespace pilotage
