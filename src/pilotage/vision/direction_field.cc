#include "pilotage/vision/direction_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pilotage {
namespace {

/// 255 where every pixel within kDirectionReachPx is valid and in the picture.
cv::Mat seen_whole(const cv::Mat& valid) {
  const int side = 2 * kDirectionReachPx + 1;
  cv::Mat result;
  cv::erode(valid != 0, result, cv::Mat::ones(side, side, CV_8UC1), {-1, -1}, 1, cv::BORDER_CONSTANT, 0);
  return result;
}

double median_of(std::vector<float>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

}  // namespace

DirectionField direction_field(const cv::Mat& gray, const cv::Mat& valid) {
  DirectionField field{cv::Mat::zeros(gray.size(), CV_32FC2), seen_whole(valid)};
  constexpr int kSide = 2 * kDirectionReachPx - 1;
  cv::Mat smooth;
  gray.convertTo(smooth, CV_32F);
  cv::GaussianBlur(smooth, smooth, {kSide, kSide}, kDirectionSigmaPx, kDirectionSigmaPx, cv::BORDER_REPLICATE);
  std::vector<float> lengths;
  for (int row = 1; row + 1 < gray.rows; ++row) {
    const auto* above = smooth.ptr<float>(row - 1);
    const auto* at = smooth.ptr<float>(row);
    const auto* below = smooth.ptr<float>(row + 1);
    const auto* seen = field.valid.ptr<std::uint8_t>(row);
    auto* z = field.z.ptr<cv::Vec2f>(row);
    for (int col = 1; col + 1 < gray.cols; ++col) {
      if (seen[col] == 0) continue;
      const float x = 0.5F * (at[col + 1] - at[col - 1]);
      const float y = 0.5F * (below[col] - above[col]);
      z[col] = {x, y};
      lengths.push_back(std::sqrt(x * x + y * y));
    }
  }
  const auto median = static_cast<float>(std::max(median_of(lengths), kFaintGradient));
  for (auto it = field.z.begin<cv::Vec2f>(); it != field.z.end<cv::Vec2f>(); ++it) {
    const float x = (*it)[0];
    const float y = (*it)[1];
    const float length = std::sqrt(x * x + y * y);
    const float scale = length > 0 ? 1 / (length * (length + median)) : 0.0F;  // (x + iy)² = |∇|² e^{2iθ}
    *it = {scale * (x * x - y * y), scale * 2 * x * y};
  }
  return field;
}

cv::Mat direction_steps(const cv::Mat& z) {
  cv::Mat steps = cv::Mat::zeros(z.size(), CV_8UC1);
  for (int row = 0; row < z.rows; ++row) {
    const auto* from = z.ptr<cv::Vec2f>(row);
    auto* to = steps.ptr<std::uint8_t>(row);
    for (int col = 0; col < z.cols; ++col) {
      const double c = static_cast<double>(from[col][0]);
      const double s = static_cast<double>(from[col][1]);
      if (c * c + s * s <= 0.25) continue;
      const double turns = std::atan2(s, c) / (2 * std::numbers::pi);  // −½ … ½
      const int sector = static_cast<int>(std::floor((turns < 0 ? turns + 1 : turns) * kDirectionSectors));
      to[col] = static_cast<std::uint8_t>(1 + std::min(sector, kDirectionSectors - 1));
    }
  }
  return steps;
}

cv::Mat field_from_steps(const cv::Mat& steps) {
  std::array<cv::Vec2f, 256> directions;
  directions.fill({0, 0});
  for (int k = 0; k < kDirectionSectors; ++k) {
    const double angle = (k + 0.5) * 2 * std::numbers::pi / kDirectionSectors;
    directions.at(static_cast<std::size_t>(k) + 1) = {static_cast<float>(std::cos(angle)),
                                                      static_cast<float>(std::sin(angle))};
  }
  cv::Mat z(steps.size(), CV_32FC2);
  for (int row = 0; row < steps.rows; ++row) {
    const auto* from = steps.ptr<std::uint8_t>(row);
    auto* to = z.ptr<cv::Vec2f>(row);
    for (int col = 0; col < steps.cols; ++col) to[col] = directions[from[col]];
  }
  return z;
}

}  // namespace pilotage
