#include "pilotage/score/tile_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/core.hpp>

#include "pilotage/correlation/correlation_kernels.h"

namespace pilotage {
namespace {

/// The least correlation of the map's pixels half a step apart, along the diagonals, for surfaces of every second (1
/// px) and every fourth lag (2 px). A tile that is too steep for its lattice is correlated again at every lag by
/// itself, which takes longer than to do all of them so: on rougher maps there would be too many such tiles.
constexpr double kSmoothEnoughFor2 = 0.6;
constexpr double kSmoothEnoughFor4 = 0.75;
/// Smaller tiles and search areas are not worth two kinds of surfaces, and their mean and σ would suffer.
constexpr int kSmallestTileFor2_px = 32;
constexpr int kSmallestTileFor4_px = 64;
constexpr int kLeastRadius_steps = 16;

/// The positions of a search area at lags that are multiples of a step and no farther than `radius` steps.
struct Positions {
  cv::Point truth;  ///< Index of lag 0.
  cv::Size size;
};

Positions positions(const SearchArea& area, int radius, int lag_step) {
  const auto steps = [&](int room) { return std::min(radius, room / lag_step); };
  const cv::Point before(steps(area.truth.x), steps(area.truth.y));
  const cv::Point after(steps(area.positions.width - 1 - area.truth.x),
                        steps(area.positions.height - 1 - area.truth.y));
  return {before, cv::Size(before.x + after.x + 1, before.y + after.y + 1)};
}

/// First pixel of the tile in the strip's images.
cv::Point place_in(const MapStrip& strip, const SearchArea& area) {
  return {static_cast<int>(area.tile.col - strip.window.col), static_cast<int>(area.tile.row - strip.window.row)};
}

/// Turns a row of sums of products into correlations; `lag` is that of its first element.
void normalise_row(const MapStrip& strip, const SearchArea& area, const cv::Point& lag, int lag_step, float mean,
                   float scale, std::span<float> values) {
  const cv::Point at = place_in(strip, area) + lag;
  normalise(strip.window_sum.ptr<float>(at.y) + at.x, strip.inverse_norm.ptr<float>(at.y) + at.x,
            static_cast<std::size_t>(lag_step), mean, scale, values.size(), values.data());
}

/// Correlations of a tile of the map at a lag and its neighbours by plain sums.
std::vector<SurfaceValue> values_around(const MapStrip& strip, const SearchArea& area, const cv::Mat& tile,
                                        cv::Point lag) {
  if (area.positions.width < 3 || area.positions.height < 3) return {};
  lag.x = std::clamp(lag.x, 1 - area.truth.x, area.positions.width - 2 - area.truth.x);
  lag.y = std::clamp(lag.y, 1 - area.truth.y, area.positions.height - 2 - area.truth.y);
  const cv::Point place = place_in(strip, area);
  const cv::Point corner = place + lag - cv::Point(1, 1);
  const float mean = strip.window_sum.at<float>(place) / static_cast<float>(tile.total());
  const float scale = strip.inverse_norm.at<float>(place);
  std::array<double, 9> sums{};
  for (int row = 0; row < tile.rows; ++row) {
    std::array<const float*, 3> map{};
    for (int dy = 0; dy < 3; ++dy) {
      map[static_cast<std::size_t>(dy)] = strip.centred.ptr<float>(corner.y + row + dy) + corner.x;
    }
    add_products_3x3(tile.ptr<float>(row), map.data(), static_cast<std::size_t>(tile.cols), sums.data());
  }
  std::vector<SurfaceValue> result;
  for (int dy = -1; dy <= 1; ++dy) {
    std::array<float, 3> values{};
    for (std::size_t dx = 0; dx < 3; ++dx)
      values[dx] = static_cast<float>(sums[static_cast<std::size_t>(3 * dy + 3) + dx]);
    normalise_row(strip, area, lag + cv::Point(-1, dy), 1, mean, scale, values);
    for (int dx = -1; dx <= 1; ++dx) {
      result.push_back({lag + cv::Point(dx, dy), values[static_cast<std::size_t>(dx + 1)]});
    }
  }
  return result;
}

}  // namespace

SearchArea::SearchArea(const TileMatrix& matrix, std::int64_t column, std::int64_t row, int radius_px)
    : tile(matrix.tile_window(column, row)),
      window(matrix.search_window(column, row, radius_px)),
      truth(static_cast<int>(tile.col - window.col), static_cast<int>(tile.row - window.row)),
      positions(window.width - tile.width + 1, window.height - tile.height + 1) {}

int choose_lag_step(const MapSample& sample, int tile_size_px, int radius_px) {
  const auto fits = [&](int step, int smallest_tile_px) {
    return tile_size_px >= smallest_tile_px && radius_px >= kLeastRadius_steps * step &&
           radius_px >= 2 * near_radius_px(tile_size_px);
  };
  if (fits(4, kSmallestTileFor4_px) && sample.diagonal_correlation_2px >= kSmoothEnoughFor4) return 4;
  if (fits(2, kSmallestTileFor2_px) && sample.diagonal_correlation_1px >= kSmoothEnoughFor2) return 2;
  return 1;
}

CleanSurfaces::CleanSurfaces(const TileMatrix& matrix, int radius_px, int lag_step, std::int64_t first_column,
                             std::int64_t columns)
    : sums_(matrix, radius_px, lag_step, first_column, columns) {
  if (lag_step > 1) near_.emplace(matrix, near_radius_px(matrix.tile_size_px), 1, first_column, columns);
}

std::size_t CleanSurfaces::bytes_per_column(const TileMatrix& matrix, int radius_px, int lag_step) {
  std::size_t bytes = BlockSums::bytes_per_column(matrix, radius_px, lag_step);
  if (lag_step > 1) bytes += BlockSums::bytes_per_column(matrix, near_radius_px(matrix.tile_size_px), 1);
  return bytes;
}

void CleanSurfaces::prepare(const MapStrip& strip, std::int64_t tile_row, std::span<const std::int64_t> tile_columns) {
  sums_.prepare(strip, tile_row, tile_columns);
  if (near_) near_->prepare(strip, tile_row, tile_columns);
}

cv::Mat CleanSurfaces::normalised(const BlockSums& sums, const MapStrip& strip, const SearchArea& area,
                                  std::int64_t tile_column, std::int64_t tile_row, cv::Mat& scratch) const {
  const int step = sums.lag_step();
  const auto [truth, size] = positions(area, sums.radius(), step);
  scratch.create(size, CV_32F);
  const cv::Point tile = place_in(strip, area);
  // The sums of products come multiplied by the correlator's scale, and so must what is taken from them.
  const auto times = static_cast<float>(sums.scale());
  const float mean = times * strip.window_sum.at<float>(tile) / static_cast<float>(area.tile.width * area.tile.height);
  const float scale = strip.inverse_norm.at<float>(tile) / times;
  for (int row = 0; row < size.height; ++row) {
    const std::span<float> values(scratch.ptr<float>(row), static_cast<std::size_t>(size.width));
    sums.row(tile_column, tile_row, sums.radius() - truth.x, sums.radius() - truth.y + row, values);
    normalise_row(strip, area, step * cv::Point(-truth.x, row - truth.y), step, mean, scale, values);
  }
  return scratch;
}

CorrelationPeaks CleanSurfaces::peaks(const MapStrip& strip, const SearchArea& area, std::int64_t tile_column,
                                      std::int64_t tile_row, SurfaceScratch& scratch) const {
  SparseSurface surface;
  surface.step = sums_.lag_step();
  surface.lattice = normalised(sums_, strip, area, tile_column, tile_row, scratch.surface);
  surface.lattice_truth = positions(area, sums_.radius(), surface.step).truth;
  if (!near_) return correlation_peaks(surface.lattice, surface.lattice_truth, area.tile.width);
  surface.near = normalised(*near_, strip, area, tile_column, tile_row, scratch.near);
  surface.near_truth = positions(area, near_->radius(), 1).truth;
  const cv::Mat tile = strip.view(strip.centred, area.tile);
  const auto around = [&](const cv::Point& lag) { return values_around(strip, area, tile, lag); };
  if (const auto peaks = sparse_correlation_peaks(surface, area.tile.width, around)) return *peaks;
  const cv::Mat every_lag = correlation_surface(tile, strip.view(strip.centred, area.window));
  return correlation_peaks(every_lag, area.truth, area.tile.width);
}

DegradedSurfaces::DegradedSurfaces(const TileMatrix& matrix, int radius_px, std::int64_t first_column,
                                   std::int64_t columns, std::span<const Degrader> copies, int margin_px)
    : copies_(copies),
      margin_px_(margin_px),
      correlator_(matrix.tile_size_px, radius_px, matrix.stride_px),
      windows_(correlator_, matrix.stride_px, first_column, columns) {
  const int side = 2 * radius_px + 1;
  for (std::size_t copy = 0; copy < copies.size(); ++copy) {
    workspaces_.push_back(correlator_.make_workspace());
    spectra_.emplace_back(correlator_.spectrum_size());
    surfaces_.emplace_back(side, side, CV_32F);
  }
}

std::size_t DegradedSurfaces::bytes_per_column(const TileMatrix& matrix, int radius_px) {
  return WindowSpectra::bytes_per_column({matrix.tile_size_px, radius_px, matrix.stride_px}, matrix.stride_px);
}

std::vector<std::optional<CorrelationPeaks>> DegradedSurfaces::peaks(const MapStrip& strip, const SearchArea& area,
                                                                     std::int64_t tile_column, std::int64_t tile_row) {
  std::vector<std::size_t> copies;  // that are not flat
  std::vector<double> norms;
  std::vector<const float*> blocks;
  for (std::size_t copy = 0; copy < copies_.size(); ++copy) {
    cv::Mat tile = degraded_tile(strip, area.tile, copies_[copy], margin_px_);
    tile -= cv::mean(tile)[0];
    const double norm = cv::norm(tile, cv::NORM_L2);
    if (!(norm > 0)) continue;
    const std::size_t slot = copies.size();
    correlator_.forward({&tile, 1}, workspaces_[slot], spectra_[slot].data());
    blocks.push_back(spectra_[slot].data());
    copies.push_back(copy);
    norms.push_back(norm);
  }
  const int radius = correlator_.radius_px();
  const cv::Rect lags(cv::Point(radius, radius) - area.truth, area.positions);
  correlator_.correlate(blocks, windows_.of_block(strip, tile_column, tile_row), {lags.y, lags.y + lags.height},
                        workspaces_, surfaces_);
  std::vector<std::optional<CorrelationPeaks>> result(copies_.size());
  for (std::size_t slot = 0; slot < copies.size(); ++slot) {
    cv::Mat surface = surfaces_[slot](lags);
    const auto scale = static_cast<float>(1 / (norms[slot] * correlator_.scale()));
    for (int row = 0; row < surface.rows; ++row) {
      normalise_row(strip, area, cv::Point(-area.truth.x, row - area.truth.y), 1, 0, scale,
                    {surface.ptr<float>(row), static_cast<std::size_t>(surface.cols)});
    }
    result[copies[slot]] = correlation_peaks(surface, area.truth, area.tile.width);
  }
  return result;
}

cv::Mat degraded_tile(const MapStrip& strip, const PixelWindow& tile, const Degrader& degrader, int margin_px) {
  const PixelWindow around{tile.col - margin_px, tile.row - margin_px, tile.width + 2 * margin_px,
                           tile.height + 2 * margin_px};
  const PixelWindow& have = strip.window;
  const auto past = [](std::int64_t value) { return static_cast<int>(std::max<std::int64_t>(0, value)); };
  const int left = past(have.col - around.col);
  const int top = past(have.row - around.row);
  const int right = past(around.col + around.width - have.col - have.width);
  const int bottom = past(around.row + around.height - have.row - have.height);
  const cv::Mat inside = strip.view(
      strip.centred, {around.col + left, around.row + top, around.width - left - right, around.height - top - bottom});
  if (left + top + right + bottom == 0) return degrader.apply(inside);
  cv::Mat padded;
  cv::copyMakeBorder(inside, padded, top, bottom, left, right, cv::BORDER_REFLECT_101);
  return degrader.apply(padded);
}

}  // namespace pilotage
