#include "pilotage/vision/feature_detector.h"

#include <algorithm>
#include <cmath>

#include <opencv2/features2d.hpp>

namespace pilotage {
namespace {

constexpr double kCornersPerCell = 8;
constexpr int kFastMarginPx = 4;      // circle of 3 px, and the neighbours that suppression looks at
constexpr int kHarrisCandidates = 3;  // times the share: Harris ranks the best of FAST's

/// First pixel of cell `index` of `count` along an axis.
int cell_begin(int begin, int size, int index, int count) {
  return begin + static_cast<int>(static_cast<std::int64_t>(size) * index / count);
}

struct FastCorner {
  int x;
  int y;
  float score;
};

std::vector<FastCorner> fast_corners(const cv::Mat& gray, const cv::Mat& allowed, const cv::Rect& area, int threshold) {
  const cv::Rect grown(area.x - kFastMarginPx, area.y - kFastMarginPx, area.width + 2 * kFastMarginPx,
                       area.height + 2 * kFastMarginPx);
  std::vector<cv::KeyPoint> keypoints;
  cv::FAST(gray(grown), keypoints, threshold, true);
  std::vector<FastCorner> corners;
  for (const cv::KeyPoint& keypoint : keypoints) {
    const int x = static_cast<int>(keypoint.pt.x) + grown.x;
    const int y = static_cast<int>(keypoint.pt.y) + grown.y;
    if (!area.contains({x, y})) continue;
    if (!allowed.empty() && allowed.at<std::uint8_t>(y, x) == 0) continue;
    corners.push_back({x, y, keypoint.response});
  }
  return corners;
}

/// The `share` strongest of a cell's corners, appended to `result`.
void keep_strongest(const cv::Mat& gray, std::vector<FastCorner> candidates, std::size_t share,
                    std::vector<Corner>& result) {
  const auto stronger_fast = [](const FastCorner& a, const FastCorner& b) {
    if (a.score != b.score) return a.score > b.score;
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  };
  if (candidates.size() > kHarrisCandidates * share) {
    const auto end = candidates.begin() + static_cast<std::ptrdiff_t>(kHarrisCandidates * share);
    std::nth_element(candidates.begin(), end, candidates.end(), stronger_fast);
    candidates.erase(end, candidates.end());
  }
  std::vector<Corner> corners;
  for (const FastCorner& c : candidates) corners.push_back({c.x, c.y, harris_response(gray, c.x, c.y)});
  std::sort(corners.begin(), corners.end(), [](const Corner& a, const Corner& b) {
    if (a.response != b.response) return a.response > b.response;
    return a.y != b.y ? a.y < b.y : a.x < b.x;
  });
  if (corners.size() > share) corners.resize(share);
  result.insert(result.end(), corners.begin(), corners.end());
}

}  // namespace

float harris_response(const cv::Mat& gray, int x, int y) {
  std::int64_t xx = 0;
  std::int64_t yy = 0;
  std::int64_t xy = 0;
  for (int row = y - 3; row <= y + 3; ++row) {
    const auto* above = gray.ptr<std::uint8_t>(row - 1);
    const auto* here = gray.ptr<std::uint8_t>(row);
    const auto* below = gray.ptr<std::uint8_t>(row + 1);
    int row_xx = 0;
    int row_yy = 0;
    int row_xy = 0;
    for (int col = x - 3; col <= x + 3; ++col) {
      const int by_x =
          2 * (here[col + 1] - here[col - 1]) + above[col + 1] - above[col - 1] + below[col + 1] - below[col - 1];
      const int by_y =
          2 * (below[col] - above[col]) + below[col - 1] - above[col - 1] + below[col + 1] - above[col + 1];
      row_xx += by_x * by_x;
      row_yy += by_y * by_y;
      row_xy += by_x * by_y;
    }
    xx += row_xx;
    yy += row_yy;
    xy += row_xy;
  }
  // Sums are below 49 · 1020² < 2²⁶, products below 2⁵²: exact in double. A Sobel filter has a gain of 8.
  const double scale = 1.0 / (7 * 7 * 8.0 * 8.0 * 255.0 * 255.0);
  const auto a = static_cast<double>(xx);
  const auto b = static_cast<double>(yy);
  const auto c = static_cast<double>(xy);
  return static_cast<float>((a * b - c * c - 0.04 * (a + b) * (a + b)) * scale * scale);
}

std::vector<Corner> find_corners(const cv::Mat& gray, const cv::Mat& allowed, const cv::Rect& area,
                                 const CornerOptions& options) {
  std::vector<Corner> result;
  if (area.empty()) return result;
  const double side = std::sqrt(kCornersPerCell / options.corners_per_px);
  const auto cells_along = [side](int size) { return std::max(1, static_cast<int>(std::lround(size / side))); };
  const int cols = cells_along(area.width);
  const int rows = cells_along(area.height);
  const double per_cell = options.corners_per_px * area.width * area.height / (static_cast<double>(cols) * rows);

  std::vector<std::vector<FastCorner>> cells(static_cast<std::size_t>(cols) * static_cast<std::size_t>(rows));
  std::vector<int> cell_of_col(static_cast<std::size_t>(area.width));
  std::vector<int> cell_of_row(static_cast<std::size_t>(area.height));
  for (int i = 0; i < cols; ++i) {
    std::fill(cell_of_col.begin() + cell_begin(0, area.width, i, cols),
              cell_of_col.begin() + cell_begin(0, area.width, i + 1, cols), i);
  }
  for (int i = 0; i < rows; ++i) {
    std::fill(cell_of_row.begin() + cell_begin(0, area.height, i, rows),
              cell_of_row.begin() + cell_begin(0, area.height, i + 1, rows), i);
  }
  for (const FastCorner& corner : fast_corners(gray, allowed, area, options.fast_threshold)) {
    const int col = cell_of_col[static_cast<std::size_t>(corner.x - area.x)];
    const int row = cell_of_row[static_cast<std::size_t>(corner.y - area.y)];
    cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col)].push_back(
        corner);
  }
  for (int row = 0; row < rows; ++row) {
    for (int col = 0; col < cols; ++col) {
      const auto index = static_cast<std::size_t>(row) * static_cast<std::size_t>(cols) + static_cast<std::size_t>(col);
      // Shares are whole numbers that add up to the density over all cells.
      const auto share = static_cast<std::size_t>(std::floor(per_cell * static_cast<double>(index + 1)) -
                                                  std::floor(per_cell * static_cast<double>(index)));
      if (share == 0) continue;
      auto& corners = cells[index];
      if (corners.size() < share && options.min_fast_threshold < options.fast_threshold) {
        const int x = cell_begin(area.x, area.width, col, cols);
        const int y = cell_begin(area.y, area.height, row, rows);
        const cv::Rect cell(x, y, cell_begin(area.x, area.width, col + 1, cols) - x,
                            cell_begin(area.y, area.height, row + 1, rows) - y);
        corners = fast_corners(gray, allowed, cell, options.min_fast_threshold);
      }
      keep_strongest(gray, std::move(corners), share, result);
    }
  }
  std::sort(result.begin(), result.end(),
            [](const Corner& a, const Corner& b) { return a.y != b.y ? a.y < b.y : a.x < b.x; });
  return result;
}

}  // namespace pilotage
