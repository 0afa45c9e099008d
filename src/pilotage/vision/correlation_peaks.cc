#include "pilotage/vision/correlation_peaks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/vision/correlation_kernels.h"

namespace pilotage {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr float kRivalShare = 0.8F;
constexpr double kLargestAssumedPeak = 0.9;

struct Lobe {
  int reach = 0;  ///< Farthest column or row of the region from the true position.
  int area = 0;   ///< Pixels of the region.
};

/// The 4-connected region above half of the peak, looked for within `limit` columns and rows.
Lobe main_lobe(const cv::Mat& surface, const cv::Point& truth, float half, int limit) {
  const cv::Rect inside = cv::Rect(truth.x - limit, truth.y - limit, 2 * limit + 1, 2 * limit + 1) &
                          cv::Rect(0, 0, surface.cols, surface.rows);
  cv::Mat seen = cv::Mat::zeros(inside.size(), CV_8U);
  std::vector<cv::Point> open{truth};
  seen.at<std::uint8_t>(truth - inside.tl()) = 1;
  Lobe lobe;
  while (!open.empty()) {
    const cv::Point point = open.back();
    open.pop_back();
    ++lobe.area;
    lobe.reach = std::max({lobe.reach, std::abs(point.x - truth.x), std::abs(point.y - truth.y)});
    for (const cv::Point step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point next = point + step;
      if (!inside.contains(next) || !(surface.at<float>(next) > half)) continue;
      std::uint8_t& mark = seen.at<std::uint8_t>(next - inside.tl());
      if (mark == 0) open.push_back(next);
      mark = 1;
    }
  }
  return lobe;
}

struct Outside {
  std::int64_t count = 0;
  double sum = 0;
  double squares = 0;
  float highest = -std::numeric_limits<float>::infinity();
  cv::Point where;
  std::int64_t rivals = 0;
};

bool is_local_maximum(const cv::Mat& surface, int col, int row) {
  const float here = surface.at<float>(row, col);
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if ((dx == 0 && dy == 0) || row + dy < 0 || row + dy >= surface.rows || col + dx < 0 ||
          col + dx >= surface.cols) {
        continue;
      }
      const float there = surface.at<float>(row + dy, col + dx);
      const bool before = dy < 0 || (dy == 0 && dx < 0);
      if (before ? there >= here : there > here) return false;
    }
  }
  return true;
}

/// Columns [from, to) of one row.
void add_span(const cv::Mat& surface, int row, int from, int to, float threshold, Outside& outside) {
  const float* values = surface.ptr<float>(row);
  const SpanSums sums = sum_span(values + from, static_cast<std::size_t>(to - from));
  outside.count += static_cast<std::int64_t>(sums.count);
  outside.sum += sums.sum;
  outside.squares += sums.squares;
  const float highest = sums.highest;
  if (highest > outside.highest) {
    outside.highest = highest;
    outside.where = {static_cast<int>(std::find(values + from, values + to, highest) - values), row};
  }
  if (!(highest >= threshold)) return;
  for (int c = from; c < to; ++c) {
    if (values[c] >= threshold && is_local_maximum(surface, c, row)) ++outside.rivals;
  }
}

/// trace(C⁻¹)/2 of the matrix C of second differences of −R, px² per unit of correlation; NaN without a maximum.
double mean_inverse_curvature(const cv::Mat& surface, const cv::Point& truth) {
  if (truth.x < 1 || truth.y < 1 || truth.x + 1 >= surface.cols || truth.y + 1 >= surface.rows) return kNaN;
  const auto at = [&](int dx, int dy) { return static_cast<double>(surface.at<float>(truth.y + dy, truth.x + dx)); };
  const double xx = 2 * at(0, 0) - at(-1, 0) - at(1, 0);
  const double yy = 2 * at(0, 0) - at(0, -1) - at(0, 1);
  const double xy = -(at(1, 1) - at(1, -1) - at(-1, 1) + at(-1, -1)) / 4;
  const double determinant = xx * yy - xy * xy;
  if (!(xx > 0 && yy > 0 && determinant > 0)) return kNaN;
  return (xx + yy) / determinant / 2;
}

}  // namespace

CorrelationPeaks correlation_peaks(const cv::Mat& surface, const cv::Point& truth, int tile_size_px) {
  if (surface.type() != CV_32FC1) throw UsageError("correlation_peaks needs a CV_32F surface");
  if (!cv::Rect(0, 0, surface.cols, surface.rows).contains(truth)) {
    throw UsageError("correlation_peaks: true position (" + std::to_string(truth.x) + ", " + std::to_string(truth.y) +
                     ") lies outside the surface");
  }
  const float peak = surface.at<float>(truth);
  CorrelationPeaks result{kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN, kNaN};
  if (std::isnan(peak)) return result;
  result.peak = static_cast<double>(peak);

  const int limit = std::max(2, tile_size_px / 16);
  Lobe lobe{0, 1};
  if (peak > 0) {
    lobe = main_lobe(surface, truth, peak / 2, limit);
    result.half_width_px = std::sqrt(lobe.area / std::numbers::pi);
    const double rho = std::min(result.peak, kLargestAssumedPeak);
    const double samples = std::max(1.0, static_cast<double>(tile_size_px) * tile_size_px / lobe.area);
    result.expected_error_px = std::sqrt((1 - rho * rho) / (rho * samples) * mean_inverse_curvature(surface, truth));
  }

  const int hidden = std::clamp(2 * lobe.reach, 2, limit);
  const float threshold = peak > 0 ? kRivalShare * peak : std::numeric_limits<float>::infinity();
  Outside outside;
  for (int row = 0; row < surface.rows; ++row) {
    if (std::abs(row - truth.y) > hidden) {
      add_span(surface, row, 0, surface.cols, threshold, outside);
    } else {
      add_span(surface, row, 0, std::max(0, truth.x - hidden), threshold, outside);
      add_span(surface, row, std::min(surface.cols, truth.x + hidden + 1), surface.cols, threshold, outside);
    }
  }
  if (outside.count == 0) return result;

  result.rival = static_cast<double>(outside.highest);
  result.margin = result.peak - result.rival;
  result.rival_dx_px = outside.where.x - truth.x;
  result.rival_dy_px = outside.where.y - truth.y;
  const auto count = static_cast<double>(outside.count);
  const double mean = outside.sum / count;
  const double variance = outside.squares / count - mean * mean;
  if (variance > 1e-12) result.psr = (result.peak - mean) / std::sqrt(variance);
  if (peak > 0) {
    result.rival_ratio = result.rival / result.peak;
    result.rivals = static_cast<double>(outside.rivals);
  }
  return result;
}

}  // namespace pilotage
