#include "pilotage/match/ground_heights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pilotage {
namespace {

/// Of the smoothing, in cells: the shape of the country, what is in it, and what smoothing took off its hills.
constexpr std::array<double, 3> kSmoothingCells{6, 1, 1};
/// What a cell without neighbours weighs: less than one point three standard deviations off.
constexpr float kLeastWeight = 1e-4F;

/// Height at `origin_px` and slopes, by least squares; level where points do not say.
Eigen::Vector3d fit_plane(const std::vector<Eigen::Vector2d>& places_px, const std::vector<double>& heights_m,
                          const Eigen::Vector2d& origin_px, double level_px) {
  Eigen::Vector2d middle_px(0, 0);
  double mean_m = 0;
  for (std::size_t i = 0; i < places_px.size(); ++i) {
    middle_px += places_px[i];
    mean_m += heights_m[i];
  }
  const auto count = static_cast<double>(places_px.size());
  middle_px /= count;
  mean_m /= count;
  // A pixel of each feature is nothing beside what a window of them spans, and enough for points on a line.
  Eigen::Matrix2d normal = count * level_px * level_px * Eigen::Matrix2d::Identity();
  Eigen::Vector2d right(0, 0);
  for (std::size_t i = 0; i < places_px.size(); ++i) {
    const Eigen::Vector2d off = places_px[i] - middle_px;
    normal += off * off.transpose();
    right += off * (heights_m[i] - mean_m);
  }
  const Eigen::Vector2d slope = normal.ldlt().solve(right);
  return {mean_m + slope.dot(origin_px - middle_px), slope.x(), slope.y()};
}

}  // namespace

GroundHeights::GroundHeights(const std::vector<Eigen::Vector2d>& places_px, const std::vector<double>& heights_m,
                             double level_px) {
  std::vector<Eigen::Vector2d> at_px;
  std::vector<double> high_m;
  for (std::size_t i = 0; i < places_px.size(); ++i) {
    if (!std::isfinite(heights_m[i])) continue;
    at_px.push_back(places_px[i]);
    high_m.push_back(heights_m[i]);
  }
  if (at_px.empty()) return;
  low_px_ = high_px_ = at_px.front();
  for (const Eigen::Vector2d& place : at_px) {
    low_px_ = low_px_.cwiseMin(place);
    high_px_ = high_px_.cwiseMax(place);
  }
  plane_ = fit_plane(at_px, high_m, low_px_, level_px);
  columns_ = static_cast<int>((high_px_.x() - low_px_.x()) / kHeightCellPx) + 1;
  rows_ = static_cast<int>((high_px_.y() - low_px_.y()) / kHeightCellPx) + 1;
  cells_m_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0.0F);
  const cv::Mat cells(rows_, columns_, CV_32F, cells_m_.data());
  for (const double sigma_cells : kSmoothingCells) {
    cv::Mat sums = cv::Mat::zeros(cells.size(), CV_32F);
    cv::Mat weights = cv::Mat::zeros(cells.size(), CV_32F);
    for (std::size_t i = 0; i < at_px.size(); ++i) {
      const Eigen::Vector2d cell = (at_px[i] - low_px_) / kHeightCellPx;
      const cv::Point at(static_cast<int>(cell.x()), static_cast<int>(cell.y()));
      sums.at<float>(at) += static_cast<float>(high_m[i] - plane_m(at_px[i]) - smoothed_m(at_px[i]));
      weights.at<float>(at) += 1;
    }
    cv::GaussianBlur(sums, sums, {}, sigma_cells, sigma_cells, cv::BORDER_CONSTANT);
    cv::GaussianBlur(weights, weights, {}, sigma_cells, sigma_cells, cv::BORDER_CONSTANT);
    cells += sums / (weights + kLeastWeight);
  }
}

double GroundHeights::height_m(const Eigen::Vector2d& place_px) const {
  if (!known()) return std::numeric_limits<double>::quiet_NaN();
  const Eigen::Vector2d inside = place_px.cwiseMax(low_px_).cwiseMin(high_px_);
  return plane_m(inside) + smoothed_m(inside);
}

double GroundHeights::plane_m(const Eigen::Vector2d& place_px) const {
  return plane_(0) + plane_.tail<2>().dot(place_px - low_px_);
}

double GroundHeights::smoothed_m(const Eigen::Vector2d& place_px) const {
  const Eigen::Vector2d cell = (place_px - low_px_) / kHeightCellPx - Eigen::Vector2d(0.5, 0.5);
  const double x = std::clamp(cell.x(), 0.0, columns_ - 1.0);
  const double y = std::clamp(cell.y(), 0.0, rows_ - 1.0);
  const int left = std::min(static_cast<int>(x), std::max(columns_ - 2, 0));
  const int top = std::min(static_cast<int>(y), std::max(rows_ - 2, 0));
  const int right = std::min(left + 1, columns_ - 1);
  const int bottom = std::min(top + 1, rows_ - 1);
  const auto value = [&](int column, int row) {
    return static_cast<double>(cells_m_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                                        static_cast<std::size_t>(column)]);
  };
  const double across = x - left;
  const double down = y - top;
  return (1 - down) * ((1 - across) * value(left, top) + across * value(right, top)) +
         down * ((1 - across) * value(left, bottom) + across * value(right, bottom));
}

double ground_heights_bytes(double side_px) {
  constexpr double kPlanes = 6;  // of floats: cells, sums, weights, and what is made of them on the way
  const double cells = side_px / kHeightCellPx + 1;
  return kPlanes * sizeof(float) * cells * cells;
}

}  // namespace pilotage
