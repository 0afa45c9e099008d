#include "pilotage/degradation/degradation_fields.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pilotage {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

/// Mean 0 and variance 1 (a flat field stays as it is).
cv::Mat normalised(const cv::Mat& field) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(field, mean, deviation);
  return deviation[0] > 0 ? cv::Mat((field - mean[0]) / deviation[0]) : field;
}

}  // namespace

cv::Mat white_field(cv::Size size, Random random) {
  cv::Mat field(size, CV_32F);
  for (int row = 0; row < size.height; ++row) {
    float* values = field.ptr<float>(row);
    for (int col = 0; col < size.width; ++col) values[col] = static_cast<float>(random.normal());
  }
  return field;
}

void blur(const cv::Mat& from, cv::Mat& to, double sigma_px) {
  const int side = 2 * static_cast<int>(std::ceil(2.5 * sigma_px)) + 1;
  cv::GaussianBlur(from, to, {side, side}, sigma_px, sigma_px, cv::BORDER_REFLECT_101);
}

cv::Mat local_strength(const cv::Mat& fine, double sigma_px) {
  const cv::Size coarse_size(std::max(1, fine.cols / 4), std::max(1, fine.rows / 4));
  cv::Mat squares;
  cv::resize(fine.mul(fine), squares, coarse_size, 0, 0, cv::INTER_AREA);
  blur(squares, squares, std::max(0.5, sigma_px / 2));
  cv::sqrt(squares, squares);
  cv::Mat strength;
  cv::resize(squares, strength, fine.size(), 0, 0, cv::INTER_LINEAR);
  return strength;
}

cv::Mat texture_field(int size_px, double sigma_px, const Random& random) {
  const cv::Mat field = white_field({size_px, size_px}, random);
  cv::Mat coarse;
  blur(field, coarse, sigma_px);
  return normalised(field - coarse);
}

cv::Mat wave_field(int size_px, double amplitude, Random random) {
  const double direction = random.uniform(0, kTwoPi);
  const double phase = random.uniform(0, kTwoPi);
  const double wave_number = kTwoPi * random.uniform(0.5, 1.5) / size_px;
  cv::Mat field(size_px, size_px, CV_32F);
  for (int row = 0; row < size_px; ++row) {
    for (int col = 0; col < size_px; ++col) {
      const double along = std::cos(direction) * col + std::sin(direction) * row;
      field.at<float>(row, col) = static_cast<float>(1 + amplitude * std::cos(wave_number * along + phase));
    }
  }
  return field;
}

}  // namespace pilotage
