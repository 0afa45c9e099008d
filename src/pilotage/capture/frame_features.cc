#include "pilotage/capture/frame_features.h"

#include <algorithm>
#include <cmath>

#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace pilotage {
namespace {

constexpr int kLongSide_px = 1600;
constexpr int kCellColumns = 24;
constexpr int kCellRows = 18;
constexpr int kMostPerCell = 10;
// Fields and water have little contrast: half of Lowe's 0.04 (OpenCV divides it by the octave's layers).
constexpr double kContrastThreshold = 0.02;

bool stronger(const cv::KeyPoint& a, const cv::KeyPoint& b) {
  if (a.response != b.response) return a.response > b.response;
  if (a.pt.y != b.pt.y) return a.pt.y < b.pt.y;
  if (a.pt.x != b.pt.x) return a.pt.x < b.pt.x;
  return a.angle < b.angle;
}

/// The strongest of each cell, so that a bright corner of the picture does not take them all.
std::vector<cv::KeyPoint> spread(std::vector<cv::KeyPoint> all, const cv::Size& size) {
  std::sort(all.begin(), all.end(), stronger);
  std::vector<int> taken(kCellColumns * kCellRows, 0);
  std::vector<cv::KeyPoint> kept;
  for (const cv::KeyPoint& point : all) {
    const int column = std::clamp(static_cast<int>(point.pt.x * kCellColumns / size.width), 0, kCellColumns - 1);
    const int row = std::clamp(static_cast<int>(point.pt.y * kCellRows / size.height), 0, kCellRows - 1);
    if (taken[static_cast<std::size_t>(row * kCellColumns + column)]++ < kMostPerCell) kept.push_back(point);
  }
  std::stable_sort(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.size > b.size; });
  return kept;
}

cv::Mat roots_of(cv::Mat histograms) {
  for (int row = 0; row < histograms.rows; ++row) {
    cv::Mat one = histograms.row(row);
    const double sum = cv::sum(one)[0];
    if (sum > 0) one /= sum;
  }
  cv::sqrt(histograms, histograms);
  cv::Mat scaled;
  histograms.convertTo(scaled, CV_8U, kRootScale);
  return scaled;
}

}  // namespace

FrameFeatures find_frame_features(const cv::Mat& gray8) {
  const double scale = std::min(1.0, static_cast<double>(kLongSide_px) / std::max(gray8.cols, gray8.rows));
  cv::Mat smaller = gray8;
  if (scale < 1) {
    const cv::Size size(std::max(1, static_cast<int>(std::lround(gray8.cols * scale))),
                        std::max(1, static_cast<int>(std::lround(gray8.rows * scale))));
    cv::resize(gray8, smaller, size, 0, 0, cv::INTER_AREA);
  }
  const cv::Ptr<cv::SIFT> sift = cv::SIFT::create(0, 3, kContrastThreshold);
  std::vector<cv::KeyPoint> points;
  sift->detect(smaller, points);
  points = spread(std::move(points), smaller.size());
  FrameFeatures features;
  features.pixel_sigma_px = 2.0 / 3 / scale;
  if (points.empty()) return features;
  cv::Mat histograms;
  sift->compute(smaller, points, histograms);
  features.descriptors = roots_of(histograms);
  const double x_scale = static_cast<double>(gray8.cols) / smaller.cols;
  const double y_scale = static_cast<double>(gray8.rows) / smaller.rows;
  features.pixels.reserve(points.size());
  for (const cv::KeyPoint& point : points) {
    features.pixels.emplace_back((point.pt.x + 0.5) * x_scale, (point.pt.y + 0.5) * y_scale);
  }
  return features;
}

}  // namespace pilotage
