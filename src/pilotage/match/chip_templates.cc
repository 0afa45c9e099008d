#include "pilotage/match/chip_templates.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pilotage {
namespace {

constexpr double kBeyondPx = 1e9;  // farther than any corner

/// The pixels about the nadir point that lie within the frame's rectangle turned and scaled.
Canvas bounds_of(const ChipFrame& frame, const ChipHypothesis& hypothesis) {
  const Eigen::Vector2d nadir = frame.nadir_px;
  const double turn = hypothesis.yaw_deg * std::numbers::pi / 180;
  Eigen::Vector2d low(kBeyondPx, kBeyondPx);
  Eigen::Vector2d high = -low;
  for (const double x : {0.0, static_cast<double>(frame.z.cols)}) {
    for (const double y : {0.0, static_cast<double>(frame.z.rows)}) {
      const Eigen::Vector2d arm = hypothesis.scale * (Eigen::Vector2d(x, y) - nadir);
      const Eigen::Vector2d corner(std::cos(turn) * arm.x() - std::sin(turn) * arm.y(),
                                   std::sin(turn) * arm.x() + std::cos(turn) * arm.y());
      low = low.cwiseMin(corner);
      high = high.cwiseMax(corner);
    }
  }
  const int left = static_cast<int>(std::floor(low.x()));
  const int top = static_cast<int>(std::floor(low.y()));
  return {left, top, static_cast<int>(std::ceil(high.x())) - left, static_cast<int>(std::ceil(high.y())) - top};
}

Canvas intersection(const Canvas& a, const Canvas& b) {
  const int left = std::max(a.left, b.left);
  const int top = std::max(a.top, b.top);
  return {left, top, std::min(a.left + a.width, b.left + b.width) - left,
          std::min(a.top + a.height, b.top + b.height) - top};
}

struct Warped {
  cv::Mat z;      // CV_32FC2
  cv::Mat valid;  // CV_8U: 255 where the four pixels that linear interpolation needs are valid
};

/// The frame turned and scaled: canvas position p shows the frame at nadir + R(−yaw)·p/scale. Directions turn along, so
/// their doubled angles turn by 2·yaw.
Warped warp(const ChipFrame& frame, const ChipHypothesis& hypothesis, const Canvas& canvas) {
  const double turn = hypothesis.yaw_deg * std::numbers::pi / 180;
  const double c = std::cos(turn) / hypothesis.scale;
  const double s = std::sin(turn) / hypothesis.scale;
  const Eigen::Vector2d nadir = frame.nadir_px;
  // From the centre of canvas pixel (0, 0), relative to the nadir point; OpenCV's first centre is (0, 0).
  const Eigen::Vector2d first(canvas.left + 0.5, canvas.top + 0.5);
  const cv::Matx23d map(c, s, nadir.x() + c * first.x() + s * first.y() - 0.5,  //
                        -s, c, nadir.y() - s * first.x() + c * first.y() - 0.5);
  const cv::Size size(canvas.width, canvas.height);
  constexpr int kFlags = cv::INTER_LINEAR | cv::WARP_INVERSE_MAP;
  Warped result;
  cv::warpAffine(frame.z, result.z, map, size, kFlags, cv::BORDER_CONSTANT, 0);
  cv::warpAffine(frame.valid, result.valid, map, size, kFlags, cv::BORDER_CONSTANT, 0);
  result.valid = result.valid == 255;
  const double c2 = std::cos(2 * turn);
  const double s2 = std::sin(2 * turn);
  cv::transform(result.z, result.z, cv::Matx22d(c2, -s2, s2, c2));
  return result;
}

}  // namespace

std::optional<ChipTemplates> make_chip_templates(const ChipFrame& frame,
                                                 const std::vector<ChipHypothesis>& hypotheses) {
  Canvas canvas = bounds_of(frame, hypotheses.front());
  for (const ChipHypothesis& hypothesis : hypotheses) canvas = intersection(canvas, bounds_of(frame, hypothesis));
  if (canvas.width < 1 || canvas.height < 1) return std::nullopt;
  ChipTemplates result;
  result.mask = cv::Mat(canvas.height, canvas.width, CV_8UC1, cv::Scalar(255));
  for (const ChipHypothesis& hypothesis : hypotheses) {
    const Warped warped = warp(frame, hypothesis, canvas);
    result.mask &= warped.valid;
    result.z.push_back(warped.z);
  }
  const cv::Rect used = cv::boundingRect(result.mask);
  if (used.empty()) return std::nullopt;
  result.canvas = {canvas.left + used.x, canvas.top + used.y, used.width, used.height};
  result.mask = result.mask(used);
  for (cv::Mat& z : result.z) z = z(used);
  return result;
}

}  // namespace pilotage
