#include "pilotage/tile/tile_map_sigma.h"

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "pilotage/base/text.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/map_sigma.h"

namespace pilotage {
namespace {

/// Samples across a tile.
constexpr int kSamples = 8;

/// One raster of imagery over a level, in samples: where it shows ground, and how far it may be off there.
struct SampledDataset {
  GraySource shown;
  std::optional<GraySource> sigma_m;  ///< Nothing where it does not say.
};

SampledDataset sample_dataset(const ImageryDataset& image, const Ground& ground, const GridLevel& level, int factor) {
  GeoTransform map_from_sample = level.matrix.map_from_pixel;
  map_from_sample.x_per_col *= factor;
  map_from_sample.y_per_row *= factor;
  const auto samples = [factor](std::int64_t pixels) { return (pixels + factor - 1) / factor; };
  const std::int64_t width = samples(level.matrix.grid_width_px);
  const std::int64_t height = samples(level.matrix.grid_height_px);
  SampledDataset sampled;
  sampled.shown =
      open_valid_on_grid({image.dataset}, ground.crs, map_from_sample, width, height, ground.imagery.options);
  if (!image.map_sigma.empty()) {
    sampled.sigma_m = open_map_sigma({image.map_sigma}, ground.crs, map_from_sample, width, height);
  }
  return sampled;
}

/// What is on top counts: what it says, kUnknownMapSigma_m of what says nothing. `said`: whether any of it was said.
Raster topmost_sigma_m(const std::vector<SampledDataset>& datasets, const PixelWindow& window, bool& said) {
  Raster top;
  top.pixels = cv::Mat(window.height, window.width, CV_64F, cv::Scalar(0));
  top.valid = cv::Mat(window.height, window.width, CV_8U, cv::Scalar(0));
  cv::Mat saying(window.height, window.width, CV_8U, cv::Scalar(0));
  for (const SampledDataset& dataset : datasets) {
    cv::Mat shown = dataset.shown.read(window).valid;
    if (cv::countNonZero(shown) == 0) continue;
    if (dataset.sigma_m) {
      const Raster sigma_m = dataset.sigma_m->read(window);
      shown = shown & sigma_m.valid;  // it may end a little before the imagery does
      cv::Mat values;
      sigma_m.pixels.convertTo(values, CV_64F);
      values.copyTo(top.pixels, shown);
      saying.setTo(255, shown);
    } else {
      top.pixels.setTo(kUnknownMapSigma_m, shown);
      saying.setTo(0, shown);
    }
    top.valid.setTo(255, shown);
  }
  said = said || cv::countNonZero(saying) > 0;
  return top;
}

}  // namespace

bool measure_map_sigma(Ground& ground) {
  std::vector<std::string> names;
  for (const ImageryDataset& image : ground.imagery.datasets) {
    if (!image.map_sigma.empty()) names.push_back(image.map_sigma);
  }
  bool said = false;
  for (const GridLevel& level : ground.levels) {
    const int factor = std::max(1, level.matrix.tile_size_px / kSamples);
    std::vector<SampledDataset> datasets;
    for (const ImageryDataset& image : ground.imagery.datasets) {
      datasets.push_back(sample_dataset(image, ground, level, factor));
    }
    for (GroundTile& tile : ground.tiles) {
      if (tile.level != level.matrix.level) continue;
      const PixelWindow window = ground.window_of(tile);
      const std::int64_t col = window.col / factor;
      const std::int64_t row = window.row / factor;
      const GraySource& grid = datasets.front().shown;
      const std::int64_t right = std::min(grid.width_px, (window.col + window.width + factor - 1) / factor);
      const std::int64_t bottom = std::min(grid.height_px, (window.row + window.height + factor - 1) / factor);
      const PixelWindow samples{col, row, static_cast<int>(right - col), static_cast<int>(bottom - row)};
      tile.map_sigma_m = mean_map_sigma_m(topmost_sigma_m(datasets, samples, said), join(names, ", "));
    }
  }
  return said;
}

}  // namespace pilotage
