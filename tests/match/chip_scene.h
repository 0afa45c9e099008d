#pragma once

#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"
#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/match/chip_mosaic.h"
#include "pilotage/vision/direction_field.h"

namespace pilotage::testing {

/// Smooth random ground, CV_8U.
inline cv::Mat random_ground(int width, int height, std::uint64_t seed) {
  Random random(seed);
  cv::Mat noise(height, width, CV_32F);
  for (auto it = noise.begin<float>(); it != noise.end<float>(); ++it) *it = static_cast<float>(random.normal());
  cv::Mat fine;
  cv::Mat coarse;
  cv::GaussianBlur(noise, fine, {}, 1.5);
  cv::GaussianBlur(noise, coarse, {}, 6.0);
  cv::Mat gray;
  cv::Mat(110 + 90 * fine + 250 * coarse).convertTo(gray, CV_8U);
  return gray;
}

/// The chips of ground that goes on beyond its edges.
inline ChipMosaic mosaic_of(const cv::Mat& gray, std::int64_t first_col_px, std::int64_t first_row_px, int factor) {
  cv::Mat grown;
  constexpr int kMore = kDirectionReachPx;
  cv::copyMakeBorder(gray, grown, kMore, kMore, kMore, kMore, cv::BORDER_REFLECT);
  const DirectionField field = direction_field(grown, cv::Mat(grown.size(), CV_8UC1, cv::Scalar(255)));
  const cv::Rect inside(kMore, kMore, gray.cols, gray.rows);
  return {direction_steps(field.z)(inside).clone(), field.valid(inside).clone(), first_col_px, first_row_px, factor};
}

/// What a camera above mosaic position `nadir` would show of the ground in a rectangle of width × height mosaic pixels
/// about it (and what its directions need beyond), turned by `rectangle_deg`: read from the mosaic after turning it by
/// −yaw_deg and scaling by 1/scale about the nadir point, so that turning the frame by yaw_deg and scaling it by
/// `scale` gives the mosaic again.
inline RectifiedFrame frame_over(const cv::Mat& ground, const Eigen::Vector2d& nadir, int width, int height,
                                 double rectangle_deg = 0, double yaw_deg = 0, double scale = 1) {
  const int half = static_cast<int>(std::ceil(std::hypot(width, height) / 2)) + 2 * kDirectionReachPx;
  const double turn = yaw_deg * std::numbers::pi / 180;
  const double c = scale * std::cos(turn);
  const double s = scale * std::sin(turn);
  const Eigen::Vector2d first(0.5 - half, 0.5 - half);
  const cv::Matx23d map(c, -s, nadir.x() + c * first.x() - s * first.y() - 0.5,  //
                        s, c, nadir.y() + s * first.x() + c * first.y() - 0.5);
  RectifiedFrame frame;
  frame.status = RectifyStatus::kOk;
  frame.gsd_m = 1.25;
  frame.origin_m = {-half * frame.gsd_m, half * frame.gsd_m};
  cv::warpAffine(ground, frame.gray, map, cv::Size(2 * half, 2 * half), cv::INTER_CUBIC | cv::WARP_INVERSE_MAP,
                 cv::BORDER_REFLECT);
  frame.valid = cv::Mat::zeros(frame.gray.size(), CV_8UC1);
  cv::Point2f corners[4];
  const auto middle = static_cast<float>(half) - 0.5F;
  cv::RotatedRect(
      cv::Point2f(middle, middle),
      cv::Size2f(static_cast<float>(width + 2 * kDirectionReachPx), static_cast<float>(height + 2 * kDirectionReachPx)),
      static_cast<float>(rectangle_deg))
      .points(corners);
  cv::fillConvexPoly(frame.valid, std::vector<cv::Point>(corners, corners + 4), cv::Scalar(255));
  frame.gray.setTo(0, frame.valid == 0);
  return frame;
}

}  // namespace pilotage::testing
