#include "pilotage/score/usual_contrast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/matchability/matchability_model.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/raster/spread_starts.h"
#include "pilotage/vision/feature_options.h"

namespace pilotage {
namespace {

constexpr std::int64_t kWindows = 12;  // per direction
constexpr double kLeastGround = 0.5;

std::vector<std::int64_t> window_starts(std::int64_t extent_px, int side_px) {
  const std::int64_t last = std::max<std::int64_t>(extent_px - side_px, 0);
  return spread_starts(extent_px, side_px, std::clamp<std::int64_t>(last / side_px + 1, last > 0 ? 2 : 1, kWindows));
}

bool has_corners(const Raster& raster) {
  constexpr int kCircle_px = 7;  // that FAST compares; no part of it may lie where there is no ground
  cv::Mat inside;
  cv::erode(raster.valid, inside, cv::Mat::ones(kCircle_px, kCircle_px, CV_8U));
  std::vector<cv::KeyPoint> corners;
  cv::FAST(raster.pixels, corners, FeatureOptions{}.min_fast_threshold);
  const auto on_ground = std::count_if(corners.begin(), corners.end(), [&](const cv::KeyPoint& corner) {
    return inside.at<std::uint8_t>(cv::Point(corner.pt)) != 0;
  });
  return static_cast<double>(on_ground) >= kLeastMapFeatures;
}

/// σ/f̄, or NaN when the window does not count.
double contrast_of(const Raster& raster) {
  if (valid_fraction(raster.valid) < kLeastGround || !has_corners(raster)) return kNaN;
  cv::Scalar mean;
  cv::Scalar sigma;
  cv::meanStdDev(raster.pixels, mean, sigma, raster.valid);
  return mean[0] > 0 ? sigma[0] / mean[0] : kNaN;
}

}  // namespace

double usual_contrast(const GraySource& shown, int side_px) {
  if (shown.depth != CV_8U || side_px < 1) {
    throw UsageError("usual_contrast wants 8 bits and side_px = " + std::to_string(side_px) + " of at least 1");
  }
  std::vector<double> contrasts;
  for (const std::int64_t row : window_starts(shown.height_px, side_px)) {
    for (const std::int64_t col : window_starts(shown.width_px, side_px)) {
      const auto width = static_cast<int>(std::min<std::int64_t>(side_px, shown.width_px - col));
      const auto height = static_cast<int>(std::min<std::int64_t>(side_px, shown.height_px - row));
      const double contrast = contrast_of(shown.read({col, row, width, height}));
      if (!std::isnan(contrast)) contrasts.push_back(contrast);
    }
  }
  if (contrasts.empty()) return kNaN;
  const auto middle = contrasts.begin() + static_cast<std::ptrdiff_t>(contrasts.size() / 2);
  std::nth_element(contrasts.begin(), middle, contrasts.end());
  return *middle;
}

}  // namespace pilotage
