#include <cmath>
#include <mutex>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/correlation/fft_correlation.h"
#include "pilotage/evaluate/judge_tiles.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr double kMinOverlap = 0.5;

struct BothDates {
  GraySource reference;
  GraySource other;  ///< On the same grid.
};

cv::Mat as_float(const cv::Mat& pixels) {
  cv::Mat result;
  pixels.convertTo(result, CV_32F);
  return result;
}

/// Correlation of the other date's tile at every position of the search area; empty when it is not covered.
cv::Mat surface_of(const BothDates& dates, const PixelWindow& tile, const PixelWindow& area) {
  const Raster shown = dates.other.read(tile);
  if (valid_fraction(shown.valid) < kMinCoveredFraction) return {};
  const Raster region = dates.reference.read(area);
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

TileOutcome judge(const LevelScores& judged, const BothDates& dates, std::size_t index, const PlaceOnReference& place,
                  double tolerance_m, double gsd_m) {
  TileOutcome outcome;
  outcome.tile = index;
  const TileCell cell = judged.ground.tiles[index].cell();
  const PixelWindow tile = judged.matrix().tile_window(cell);
  const PixelWindow area = judged.matrix().search_window(cell, judged.level.search_radius_px);
  const cv::Mat surface = surface_of(dates, tile, area);
  if (surface.empty()) return outcome;
  const Peak peak = highest(surface);
  outcome.evidence = peak.value;
  if (!(peak.value > 0)) {
    outcome.outcome = Outcome::kRefused;
    outcome.status = "no_contrast";
    return outcome;
  }
  const Eigen::Vector2d center = judged.matrix().tile_center(cell);
  const GeoTransform& grid = judged.matrix().map_from_pixel;
  const Eigen::Vector2d true_shift_px = grid.pixel_from_map(place(center)) - grid.pixel_from_map(center);
  const Eigen::Vector2d found_shift_px(static_cast<double>(area.col + peak.at.x - tile.col),
                                       static_cast<double>(area.row + peak.at.y - tile.row));
  const Eigen::Vector2d error_px = found_shift_px - true_shift_px;
  outcome.error_m = error_px.norm() * gsd_m;
  outcome.error_east_m = error_px.x() * gsd_m;
  outcome.error_north_m = -error_px.y() * gsd_m;
  outcome.status = "peak";
  outcome.outcome = outcome_of_fix(outcome.error_m, tolerance_m);
  return outcome;
}

}  // namespace

std::vector<TileOutcome> judge_by_ncc(const LevelScores& judged, std::span<const std::size_t> tiles,
                                      const PlaceOnReference& place, const EvaluateOptions& options, double tolerance_m,
                                      int threads, const Progress& progress) {
  if (judged.level.search_radius_px < 1)
    throw UsageError("search_radius_px = 0: there is nothing to search; at least 1");
  const TileMatrix& matrix = judged.matrix();
  const BothDates dates{
      open_gray(judged.ground, judged.level),
      open_gray_on_grid({options.file}, judged.ground.crs, matrix.map_from_pixel, matrix.grid_width_px,
                        matrix.grid_height_px, second_date_options(judged.ground.imagery.options))};
  const double gsd_m = ground_gsd_m(judged);
  std::vector<TileOutcome> outcomes(tiles.size());
  std::mutex mutex;
  std::int64_t done = 0;
  const auto total = static_cast<std::int64_t>(tiles.size());
  report_progress(progress, "evaluating", done, total);
  parallel_for(tiles.size(), threads, [&](std::size_t i, int) {
    outcomes[i] = judge(judged, dates, tiles[i], place, tolerance_m, gsd_m);
    const std::lock_guard lock(mutex);
    report_progress(progress, "evaluating", ++done, total);
  });
  return outcomes;
}

}  // namespace pilotage
