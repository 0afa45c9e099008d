#include "pilotage/matchability/fine_contrast.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <mutex>
#include <string>
#include <utility>

#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"
#include "pilotage/geo/tile_groups.h"
#include "pilotage/matchability/matchability_model.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/raster/rectangle_sums.h"
#include "pilotage/raster/spread_starts.h"
#include "pilotage/vision/feature_options.h"

namespace pilotage {
namespace {

constexpr int kFineBox_px = 3;
constexpr int kSurroundings_px = 15;
constexpr int kReach_px = kSurroundings_px / 2;
constexpr double kStepsPerLevel = 256;

constexpr std::int64_t kWindows = 12;  // per direction
constexpr double kLeastGround = 0.5;

std::vector<std::int64_t> window_starts(std::int64_t extent_px, int side_px) {
  const std::int64_t last = std::max<std::int64_t>(extent_px - side_px, 0);
  return spread_starts(extent_px, side_px, std::clamp<std::int64_t>(last / side_px + 1, last > 0 ? 2 : 1, kWindows));
}

/// The window of `side_px` at a pixel and what its contrast looks at around it, as far as the source reaches.
PixelWindow surroundings(const GraySource& shown, std::int64_t col, std::int64_t row, int side_px) {
  const std::int64_t left = std::max<std::int64_t>(col - kReach_px, 0);
  const std::int64_t top = std::max<std::int64_t>(row - kReach_px, 0);
  return {left, top, static_cast<int>(std::min(col + side_px + kReach_px, shown.width_px) - left),
          static_cast<int>(std::min(row + side_px + kReach_px, shown.height_px) - top)};
}

/// The same window within its surroundings.
cv::Rect inside(const GraySource& shown, std::int64_t col, std::int64_t row, int side_px) {
  return {static_cast<int>(std::min<std::int64_t>(col, kReach_px)),
          static_cast<int>(std::min<std::int64_t>(row, kReach_px)),
          static_cast<int>(std::min<std::int64_t>(side_px, shown.width_px - col)),
          static_cast<int>(std::min<std::int64_t>(side_px, shown.height_px - row))};
}

bool counts(const Raster& raster, const cv::Rect& window) {
  if (valid_fraction(raster.valid(window)) < kLeastGround) return false;
  constexpr int kCircle_px = 7;  // that FAST compares; no part of it may lie where there is no ground
  cv::Mat on_ground;
  cv::erode(raster.valid(window), on_ground, cv::Mat::ones(kCircle_px, kCircle_px, CV_8U));
  std::vector<cv::KeyPoint> corners;
  cv::FAST(raster.pixels(window), corners, FeatureOptions{}.min_fast_threshold);
  const auto count = std::count_if(corners.begin(), corners.end(), [&](const cv::KeyPoint& corner) {
    return on_ground.at<std::uint8_t>(cv::Point(corner.pt)) != 0;
  });
  return static_cast<double>(count) >= kLeastMapFeatures;
}

void want_8bit(const GraySource& shown, const char* who) {
  if (shown.depth != CV_8U) throw UsageError(std::string(who) + " wants gray values of 8 bits");
}

/// The contrast of each pixel of ground, in kStepsPerLevel, and how many there are, over any rectangle of a window.
class ContrastSums {
 public:
  explicit ContrastSums(const Raster& raster) : ContrastSums(cv::Mat(raster.valid != 0) / 255, raster.pixels) {}

  double at(const cv::Rect& rectangle) const {
    const double count = ground_.at(rectangle);
    return count > 0 ? contrast_.at(rectangle) / (kStepsPerLevel * count) : kNaN;
  }

 private:
  ContrastSums(const cv::Mat& ground, const cv::Mat& pixels)
      : ground_(ground), contrast_(contrast_steps(ground, pixels)) {}

  static cv::Mat contrast_steps(const cv::Mat& ground, const cv::Mat& pixels) {
    const cv::Mat known = pixels.mul(ground);
    const cv::Mat fine = box_sum(known, kFineBox_px);
    const cv::Mat fine_count = box_sum(ground, kFineBox_px);
    const cv::Mat around = box_sum(known, kSurroundings_px);
    const cv::Mat around_count = box_sum(ground, kSurroundings_px);
    cv::Mat steps(pixels.size(), CV_64F, cv::Scalar(0));
    for (int row = 0; row < steps.rows; ++row) {
      const auto* is_ground = ground.ptr<std::uint8_t>(row);
      const int* n = fine_count.ptr<int>(row);
      const int* n_around = around_count.ptr<int>(row);
      for (int col = 0; col < steps.cols; ++col) {
        if (is_ground[col] == 0) continue;
        const int numerator = std::abs(fine.at<int>(row, col) * n_around[col] - around.at<int>(row, col) * n[col]);
        steps.at<double>(row, col) = std::round(kStepsPerLevel * numerator / (n[col] * n_around[col]));
      }
    }
    return steps;
  }

  RectangleSums ground_;
  RectangleSums contrast_;
};

}  // namespace

std::vector<double> measure_fine_contrast(const GraySource& shown, const TileMatrix& matrix,
                                          std::span<const std::int64_t> tile_indices, int threads,
                                          const Progress& progress) {
  want_8bit(shown, "measure_fine_contrast");
  if (matrix.grid_width_px != shown.width_px || matrix.grid_height_px != shown.height_px) {
    throw DataError("fine contrast: the tile matrix is not that of the imagery's grid");
  }
  std::vector<double> contrasts(tile_indices.size(), kNaN);
  const std::vector<TileGroup> groups = group_tiles(matrix, tile_indices, kReach_px, shown.block_width_px);
  for_each_group(groups, "fine contrast", threads, progress, [&](const TileGroup& group) {
    const ContrastSums sums(shown.read(group.window));
    for (const std::size_t result_index : group.result_indices) {
      const PixelWindow tile = group.place_of(matrix.tile_window(matrix.cell_of(tile_indices[result_index])));
      contrasts[result_index] =
          sums.at({static_cast<int>(tile.col), static_cast<int>(tile.row), tile.width, tile.height});
    }
  });
  return contrasts;
}

double usual_fine_contrast(const GraySource& shown, int side_px, int threads, const Progress& progress) {
  want_8bit(shown, "usual_fine_contrast");
  if (side_px < 1) throw UsageError("usual_fine_contrast: side_px = " + std::to_string(side_px) + ": at least 1");
  std::vector<std::pair<std::int64_t, std::int64_t>> places;  // column and row
  for (const std::int64_t row : window_starts(shown.height_px, side_px)) {
    for (const std::int64_t col : window_starts(shown.width_px, side_px)) places.emplace_back(col, row);
  }
  std::vector<double> contrasts(places.size(), kNaN);
  std::mutex mutex;
  std::int64_t done = 0;
  parallel_for(places.size(), threads, [&](std::size_t i, int) {
    const auto [col, row] = places[i];
    const Raster raster = shown.read(surroundings(shown, col, row, side_px));
    const cv::Rect window = inside(shown, col, row, side_px);
    if (counts(raster, window)) contrasts[i] = ContrastSums(raster).at(window);
    const std::lock_guard lock(mutex);
    report_progress(progress, "usual contrast", ++done, static_cast<std::int64_t>(places.size()));
  });
  std::erase_if(contrasts, [](double contrast) { return std::isnan(contrast); });
  if (contrasts.empty()) return kNaN;
  const auto middle = contrasts.begin() + static_cast<std::ptrdiff_t>(contrasts.size() / 2);
  std::nth_element(contrasts.begin(), middle, contrasts.end());
  return *middle;
}

}  // namespace pilotage
