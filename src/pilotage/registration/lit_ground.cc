#include "pilotage/registration/lit_ground.h"

#include <opencv2/imgproc.hpp>

namespace pilotage {
namespace {

// docs/methods/registration.md (Shadows) says what another value makes of known ground.
constexpr double kShadowShare = 0.7;

}  // namespace

cv::Mat lit_ground(const cv::Mat& pixels, const cv::Mat& valid, int window_px) {
  const cv::Mat ground = valid != 0;
  cv::Mat values = pixels.clone();
  values.setTo(0, ground == 0);
  cv::Mat sum;
  cv::Mat count;
  const cv::Size window(window_px, window_px);
  cv::boxFilter(values, sum, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  cv::boxFilter(ground, count, CV_32F, window, {-1, -1}, false, cv::BORDER_CONSTANT);
  // value < share · sum / (count / 255), without dividing by what may be 0
  const cv::Mat left = values.mul(count);
  const cv::Mat right = kShadowShare * 255 * sum;
  cv::Mat dark = left < right;
  dark.setTo(0, sum <= 0);
  dark.setTo(0, ground == 0);
  cv::dilate(dark, dark, cv::Mat::ones(2 * kLitEdge_px + 1, 2 * kLitEdge_px + 1, CV_8U));
  cv::Mat lit = ground.clone();
  lit.setTo(0, dark);
  return lit;
}

}  // namespace pilotage
