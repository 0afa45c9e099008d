#include <cmath>
#include <mutex>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/correlation/fft_correlation.h"
#include "pilotage/evaluate/judge_tiles.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr double kMinValidFraction = 0.9;
constexpr double kMinOverlap = 0.5;

struct Pair {
  GraySource reference;
  GraySource other;  ///< On the same grid.
};

cv::Mat as_float(const cv::Mat& pixels) {
  cv::Mat result;
  pixels.convertTo(result, CV_32F);
  return result;
}

/// Correlation of the other date's tile at every position of the search area; empty when it is not covered.
cv::Mat surface_of(const Pair& pair, const PixelWindow& tile, const PixelWindow& area) {
  const Raster shown = pair.other.read(tile);
  if (valid_fraction(shown.valid) < kMinValidFraction) return {};
  const Raster region = pair.reference.read(area);
  return masked_correlation_surface(as_float(shown.pixels), shown.valid, as_float(region.pixels), region.valid,
                                    kMinOverlap);
}

struct Peak {
  double value = 0;  ///< 0 when no position correlates.
  cv::Point at;
};

Peak highest(const cv::Mat& surface) {
  Peak peak;
  for (int y = 0; y < surface.rows; ++y) {
    const float* row = surface.ptr<float>(y);
    for (int x = 0; x < surface.cols; ++x) {
      if (static_cast<double>(row[x]) > peak.value) peak = {static_cast<double>(row[x]), {x, y}};
    }
  }
  return peak;
}

TileOutcome judge(const ScoredGround& ground, const Pair& pair, std::size_t index, const PlaceOnReference& place,
                  double tolerance_m, double gsd_m) {
  TileOutcome outcome;
  outcome.row = index;
  const TileRow& row = ground.rows[index];
  const PixelWindow tile = ground.matrix.tile_window(row.tile.column, row.tile.row);
  const PixelWindow area = ground.matrix.search_window(row.tile.column, row.tile.row, ground.search_radius_px);
  const cv::Mat surface = surface_of(pair, tile, area);
  if (surface.empty()) return outcome;
  const Peak peak = highest(surface);
  outcome.evidence = peak.value;
  if (!(peak.value > 0)) {
    outcome.outcome = Outcome::kRefused;
    outcome.status = "no_contrast";
    return outcome;
  }
  const Eigen::Vector2d center = tile_center(ground, row);
  const GeoTransform& grid = ground.matrix.map_from_pixel;
  const Eigen::Vector2d true_shift_px = grid.pixel_from_map(place(center)) - grid.pixel_from_map(center);
  const Eigen::Vector2d found_shift_px(static_cast<double>(area.col + peak.at.x - tile.col),
                                       static_cast<double>(area.row + peak.at.y - tile.row));
  const Eigen::Vector2d error_px = found_shift_px - true_shift_px;
  outcome.error_m = error_px.norm() * gsd_m;
  outcome.error_east_m = error_px.x() * gsd_m;
  outcome.error_north_m = -error_px.y() * gsd_m;
  outcome.status = "peak";
  outcome.outcome = outcome.error_m <= tolerance_m ? Outcome::kCorrect : Outcome::kFalse;
  return outcome;
}

}  // namespace

std::vector<TileOutcome> judge_by_ncc(const ScoredGround& ground, std::span<const std::size_t> tiles,
                                      const PlaceOnReference& place, const EvaluateOptions& options, double tolerance_m,
                                      int threads, const Progress& progress) {
  if (ground.search_radius_px < 1) throw UsageError("search_radius_px = 0: there is nothing to search; at least 1");
  const auto on_grid = [&](const std::vector<std::string>& datasets, const ImageryOptions& imagery) {
    return open_gray_on_grid(datasets, ground.crs, ground.matrix.map_from_pixel, ground.matrix.grid_width_px,
                             ground.matrix.grid_height_px, imagery);
  };
  const Pair pair{on_grid(ground.datasets, ground.imagery), on_grid({options.file}, {})};
  const double gsd_m = ground_gsd_m(ground);
  std::vector<TileOutcome> outcomes(tiles.size());
  std::mutex mutex;
  std::int64_t done = 0;
  const auto total = static_cast<std::int64_t>(tiles.size());
  report_progress(progress, "evaluating", done, total);
  parallel_for(tiles.size(), threads, [&](std::size_t i, int) {
    outcomes[i] = judge(ground, pair, tiles[i], place, tolerance_m, gsd_m);
    const std::lock_guard lock(mutex);
    report_progress(progress, "evaluating", ++done, total);
  });
  return outcomes;
}

}  // namespace pilotage
