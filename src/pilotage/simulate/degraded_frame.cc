#include "pilotage/simulate/degraded_frame.h"

#include <algorithm>

#include <opencv2/imgproc.hpp>

namespace pilotage {

void FrameDegrader::apply(cv::Mat& gray) {
  if (strength_ == 0) return;
  const int side = std::max(gray.cols, gray.rows);
  if (!degrader_) {
    DegradationOptions options;
    options.rotation_deg = 0;
    options.scale_percent = 0;
    for (double* share :
         {&options.texture_redrawn, &options.illumination, &options.gamma, &options.blur_px, &options.noise}) {
      *share *= strength_;
    }
    degrader_.emplace(side, 0, options, seed_, static_cast<int>(seed_ % 2));
  }
  cv::Mat square;
  gray.convertTo(square, CV_32F, 1 / 255.0);
  cv::copyMakeBorder(square, square, 0, side - gray.rows, 0, side - gray.cols, cv::BORDER_REFLECT_101);
  degrader_->apply(square)(cv::Rect(0, 0, gray.cols, gray.rows)).convertTo(gray, CV_8U, 255);
}

}  // namespace pilotage
