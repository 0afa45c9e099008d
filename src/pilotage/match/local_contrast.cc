#include "pilotage/match/local_contrast.h"

#include <algorithm>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/vision/mask_weight.h"

namespace pilotage {

cv::Mat local_contrast(const cv::Mat& gray, const cv::Mat& valid, double sigma_px) {
  const auto blurred = [&](const cv::Mat& pixels) {
    cv::Mat result;
    cv::GaussianBlur(pixels, result, {}, sigma_px, sigma_px, cv::BORDER_CONSTANT);
    return result;
  };
  const cv::Mat weight = mask_weight(valid);
  cv::Mat values;
  gray.convertTo(values, CV_32F);
  values = values.mul(weight);
  const cv::Mat total = cv::max(blurred(weight), 1e-6);
  const cv::Mat mean = blurred(values) / total;
  cv::Mat result = (values - mean).mul(weight);
  cv::Mat spread = blurred(result.mul(result)) / total + kFaintVariance;
  cv::sqrt(spread, spread);
  result /= spread;
  result = cv::min(cv::max(result, -kMostContrast), kMostContrast);
  return result;
}

}  // namespace pilotage
