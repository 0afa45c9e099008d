#include "pilotage/degradation/degradation_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pilotage {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

/// Paints the half plane, in a random direction, that covers `share` of a square: everything before the quantile of
/// the distances along the direction.
void paint_half_plane(double share, Random& random, cv::Mat& mask) {
  const double direction = random.uniform(0, kTwoPi);
  cv::Mat along(mask.size(), CV_32F);
  for (int row = 0; row < along.rows; ++row) {
    for (int col = 0; col < along.cols; ++col) {
      along.at<float>(row, col) = static_cast<float>(std::cos(direction) * col + std::sin(direction) * row);
    }
  }
  cv::Mat sorted = along.clone().reshape(1, 1);
  const auto count = static_cast<std::ptrdiff_t>(std::lround(share * static_cast<double>(sorted.total())));
  if (count < 1) return;
  float* values = sorted.ptr<float>();
  std::nth_element(values, values + count - 1, values + sorted.total());
  mask.setTo(255, along <= values[count - 1]);
}

/// The shadow of a box: an edge of it and the same edge moved along the light. Side by side with others it has the
/// light in common and not the edge.
void paint_quadrilateral(double light, int size_px, Random& random, cv::Mat& mask) {
  const double edge = random.uniform(0, kTwoPi);
  const double side = size_px * random.uniform(1.0 / 16, 0.25);
  const double length = size_px * random.uniform(1.0 / 16, 0.25);
  const cv::Point2d at(random.uniform(0, size_px), random.uniform(0, size_px));
  const cv::Point2d along(side * std::cos(edge) / 2, side * std::sin(edge) / 2);
  const cv::Point2d cast(length * std::cos(light) / 2, length * std::sin(light) / 2);
  const auto corner = [](const cv::Point2d& p) { return cv::Point(cvRound(p.x), cvRound(p.y)); };
  const std::array<cv::Point, 4> corners{corner(at - along - cast), corner(at + along - cast),
                                         corner(at + along + cast), corner(at - along + cast)};
  cv::fillConvexPoly(mask, corners.data(), static_cast<int>(corners.size()), 255);
}

/// Divides the spectrum by frequency to the power `slope`; the mean goes.
void redden(double slope, cv::Mat& field) {
  cv::Mat spectrum;
  cv::dft(field, spectrum, cv::DFT_COMPLEX_OUTPUT);
  const int size = field.rows;
  for (int row = 0; row < size; ++row) {
    for (int col = 0; col < size; ++col) {
      const double frequency = std::hypot(std::min(row, size - row), std::min(col, size - col));
      const auto factor = static_cast<float>(frequency > 0 ? std::pow(frequency, -slope) : 0);
      spectrum.at<cv::Vec2f>(row, col) *= factor;
    }
  }
  cv::dft(spectrum, field, cv::DFT_INVERSE | cv::DFT_SCALE | cv::DFT_REAL_OUTPUT);
}

}  // namespace

cv::Mat white_field(int size_px, Random random) {
  cv::Mat field(size_px, size_px, CV_32F);
  for (int row = 0; row < size_px; ++row) {
    float* values = field.ptr<float>(row);
    for (int col = 0; col < size_px; ++col) values[col] = static_cast<float>(random.normal());
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

cv::Mat normalised(const cv::Mat& field) {
  cv::Scalar mean;
  cv::Scalar deviation;
  cv::meanStdDev(field, mean, deviation);
  return deviation[0] > 0 ? cv::Mat((field - mean[0]) / deviation[0]) : field;
}

cv::Mat texture_field(int size_px, double sigma_px, double slope, const Random& random) {
  cv::Mat field = white_field(size_px, random);
  if (slope > 0) redden(slope, field);
  cv::Mat coarse;
  blur(field, coarse, sigma_px);
  return normalised(field - coarse);
}

cv::Mat wave_field(int size_px, double level, double amplitude, Random random) {
  const double direction = random.uniform(0, kTwoPi);
  const double phase = random.uniform(0, kTwoPi);
  const double wave_number = kTwoPi * random.uniform(0.5, 1.5) / size_px;
  cv::Mat field(size_px, size_px, CV_32F);
  for (int row = 0; row < size_px; ++row) {
    for (int col = 0; col < size_px; ++col) {
      const double along = std::cos(direction) * col + std::sin(direction) * row;
      field.at<float>(row, col) = static_cast<float>(level * (1 + amplitude * std::cos(wave_number * along + phase)));
    }
  }
  return field;
}

cv::Mat shadow_field(int size_px, double contrast, double share, double edge_px, Random random) {
  cv::Mat mask = cv::Mat::zeros(size_px, size_px, CV_8U);
  paint_half_plane(share / 2, random, mask);
  const double light = random.uniform(0, kTwoPi);
  while (cv::countNonZero(mask) < share * static_cast<double>(mask.total())) {
    paint_quadrilateral(light, size_px, random, mask);
  }
  cv::Mat factor;
  mask.convertTo(factor, CV_32F, -contrast / 255, 1);
  if (edge_px > 0) blur(factor, factor, edge_px);
  return factor;
}

}  // namespace pilotage
