#include "pilotage/tile/tile_map_sigma.h"

#include <algorithm>
#include <cmath>

#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/raster/gdal_gray.h"

namespace pilotage {
namespace {

/// Samples across a tile.
constexpr int kSamples = 8;
constexpr double kLargestSigma_m = 100;

/// Rows and columns of `grid`, `factor` times as coarse as `level`.
GraySource open_on_level(const std::vector<std::string>& rasters, const Ground& ground, const GridLevel& level,
                         int factor) {
  GeoTransform map_from_sample = level.matrix.map_from_pixel;
  map_from_sample.x_per_col *= factor;
  map_from_sample.y_per_row *= factor;
  const auto samples = [factor](std::int64_t pixels) { return (pixels + factor - 1) / factor; };
  ImageryOptions first_band;
  first_band.bands = {1};
  first_band.resampling = Resampling::kBilinear;  // cubic overshoots where one map ends on another
  return open_gray_on_grid(rasters, ground.crs, map_from_sample, samples(level.matrix.grid_width_px),
                           samples(level.matrix.grid_height_px), first_band);
}

std::optional<double> root_mean_square(const Raster& sigmas_m, const std::string& names) {
  cv::Mat values;
  sigmas_m.pixels.convertTo(values, CV_64F);
  double sum = 0;
  double count = 0;
  for (int row = 0; row < values.rows; ++row) {
    for (int col = 0; col < values.cols; ++col) {
      if (sigmas_m.valid.at<std::uint8_t>(row, col) == 0) continue;
      const double sigma_m = values.at<double>(row, col);
      if (!(sigma_m >= 0 && sigma_m <= kLargestSigma_m)) {
        throw DataError(names + ": " + format_number(sigma_m) + " m is no standard deviation of a map, 0 to " +
                        format_number(kLargestSigma_m) + " m");
      }
      sum += sigma_m * sigma_m;
      count += 1;
    }
  }
  if (count == 0) return std::nullopt;
  return std::sqrt(sum / count);
}

}  // namespace

void measure_map_sigma(const std::vector<std::string>& rasters, Ground& ground) {
  for (const GridLevel& level : ground.levels) {
    const int factor = std::max(1, level.matrix.tile_size_px / kSamples);
    const GraySource source = open_on_level(rasters, ground, level, factor);
    for (GroundTile& tile : ground.tiles) {
      if (tile.level != level.matrix.level) continue;
      const PixelWindow window = ground.window_of(tile);
      const std::int64_t col = window.col / factor;
      const std::int64_t row = window.row / factor;
      const std::int64_t right = std::min(source.width_px, (window.col + window.width + factor - 1) / factor);
      const std::int64_t bottom = std::min(source.height_px, (window.row + window.height + factor - 1) / factor);
      tile.map_sigma_m = root_mean_square(
          source.read({col, row, static_cast<int>(right - col), static_cast<int>(bottom - row)}), join(rasters, ", "));
    }
  }
}

}  // namespace pilotage
