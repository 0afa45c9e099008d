#include "pilotage/score/tile_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/core.hpp>

#include "pilotage/base/parallel.h"
#include "pilotage/vision/correlation_kernels.h"

namespace pilotage {
namespace {

/// Tiles of more blocks than this along a side are not put together from blocks: the sums would cost more than they
/// save.
constexpr int kMostBlocks = 8;

int blocks_per_side(const TileMatrix& matrix) {
  const int blocks = matrix.stride_px > 0 ? matrix.tile_size_px / matrix.stride_px : 1;
  return matrix.tile_size_px % matrix.stride_px == 0 && blocks <= kMostBlocks ? std::max(1, blocks) : 1;
}

BlockCorrelator make_correlator(const TileMatrix& matrix, int radius_px) {
  return {matrix.tile_size_px / blocks_per_side(matrix), radius_px, matrix.stride_px};
}

void ensure_workspaces(std::vector<RealFft2d::Workspace>& workspaces, const BlockCorrelator& correlator, int threads) {
  while (workspaces.size() < static_cast<std::size_t>(thread_count(threads))) {
    workspaces.push_back(correlator.make_workspace());
  }
}

cv::Mat make_surface(int radius_px) {
  return cv::Mat(2 * radius_px + 1, 2 * radius_px + 1, CV_32F);
}

/// out = terms[0] + … , in this order.
void add_rows(std::span<const float* const> terms, std::size_t count, float* out) {
  if (terms.size() == 4) {  // the usual number, worth one pass
    add_four(terms[0], terms[1], terms[2], terms[3], count, out);
    return;
  }
  std::copy(terms[0], terms[0] + count, out);
  for (const float* term : terms.subspan(1)) add_to(term, count, out);
}

}  // namespace

SearchArea::SearchArea(const TileMatrix& matrix, std::int64_t column, std::int64_t row, int radius_px)
    : tile(matrix.tile_window(column, row)),
      window(matrix.search_window(column, row, radius_px)),
      truth(static_cast<int>(tile.col - window.col), static_cast<int>(tile.row - window.row)),
      lags(radius_px - truth.x, radius_px - truth.y, window.width - tile.width + 1, window.height - tile.height + 1) {}

CleanSurfaces::CleanSurfaces(const TileMatrix& matrix, int radius_px, std::int64_t first_column, std::int64_t columns)
    : matrix_(matrix),
      blocks_(blocks_per_side(matrix)),
      first_column_(first_column),
      columns_(columns),
      correlator_(make_correlator(matrix, radius_px)),
      spectra_(correlator_, matrix.stride_px, first_column, columns + blocks_ - 1),
      row_sums_(static_cast<std::size_t>(columns * blocks_)) {}

std::size_t CleanSurfaces::bytes_per_column(const TileMatrix& matrix, int radius_px) {
  const auto side = static_cast<std::size_t>(2 * radius_px + 1);
  return static_cast<std::size_t>(blocks_per_side(matrix)) * side * side * sizeof(float) +
         WindowSpectra::bytes_per_column(make_correlator(matrix, radius_px), matrix.stride_px);
}

CleanSurfaces::RowSum& CleanSurfaces::row_sum(std::int64_t column, std::int64_t block_row) {
  return row_sums_[static_cast<std::size_t>(block_row % blocks_ * columns_ + column - first_column_)];
}
const CleanSurfaces::RowSum& CleanSurfaces::row_sum(std::int64_t column, std::int64_t block_row) const {
  return row_sums_[static_cast<std::size_t>(block_row % blocks_ * columns_ + column - first_column_)];
}

void CleanSurfaces::prepare(const MapStrip& strip, std::int64_t tile_row, std::span<const std::int64_t> tile_columns,
                            int threads) {
  ensure_workspaces(workspaces_, correlator_, threads);
  workers_.resize(workspaces_.size());
  for (int block = 0; block < blocks_; ++block) {
    std::vector<std::int64_t> missing;
    for (const std::int64_t column : tile_columns) {
      if (row_sum(column, tile_row + block).row != tile_row + block) missing.push_back(column);
    }
    if (!missing.empty()) prepare_block_row(strip, tile_row + block, missing, threads);
  }
}

void CleanSurfaces::prepare_block_row(const MapStrip& strip, std::int64_t block_row,
                                      const std::vector<std::int64_t>& tile_columns, int threads) {
  std::vector<bool> needed(static_cast<std::size_t>(columns_ + blocks_ - 1), false);
  for (const std::int64_t column : tile_columns) {
    for (int block = 0; block < blocks_; ++block)
      needed[static_cast<std::size_t>(column - first_column_ + block)] = true;
  }
  spectra_.prepare(
      strip, block_row, [&](std::int64_t column) { return needed[static_cast<std::size_t>(column - first_column_)]; },
      workspaces_, threads);

  // One run of tiles per thread: neighbours share blocks, and runs share none, so runs are not cut finer than needed.
  const std::size_t runs =
      std::clamp<std::size_t>(tile_columns.size() / static_cast<std::size_t>(2 * blocks_), 1, workspaces_.size());
  parallel_for(runs, threads, [&](std::size_t run, int thread) {
    const std::size_t first = tile_columns.size() * run / runs;
    const std::size_t last = tile_columns.size() * (run + 1) / runs;
    Worker& worker = workers_[static_cast<std::size_t>(thread)];
    worker.workspace = &workspaces_[static_cast<std::size_t>(thread)];
    add_up(strip, block_row, std::span(tile_columns).subspan(first, last - first), worker);
  });
}

/// Rows of the surfaces of a row of blocks that are positions on the map for any tile the blocks belong to.
cv::Range CleanSurfaces::rows_on_map(std::int64_t block_row) const {
  const std::int64_t radius = correlator_.radius_px();
  const std::int64_t top = block_row * matrix_.stride_px;                  // of the lowest of these tiles
  const std::int64_t upper_top = top - (blocks_ - 1) * matrix_.stride_px;  // and of the highest
  const std::int64_t room = matrix_.grid_height_px - matrix_.tile_size_px - upper_top;
  return {static_cast<int>(radius - std::min(radius, top)),
          static_cast<int>(radius + std::clamp<std::int64_t>(room, 0, radius) + 1)};
}

void CleanSurfaces::add_up(const MapStrip& strip, std::int64_t block_row, std::span<const std::int64_t> tile_columns,
                           Worker& worker) {
  const int side = correlator_.block_px();
  const cv::Range on_map = rows_on_map(block_row);
  const auto blocks = static_cast<std::size_t>(blocks_);
  if (worker.block.size() == 0) worker.block = AlignedFloats(correlator_.spectrum_size());
  worker.surfaces.resize(blocks);
  worker.columns.assign(blocks, -1);
  for (const std::int64_t tile_column : tile_columns) {
    std::vector<const cv::Mat*> terms;
    for (std::int64_t column = tile_column; column < tile_column + blocks_; ++column) {
      const auto slot = static_cast<std::size_t>(column % blocks_);
      terms.push_back(&worker.surfaces[slot]);
      if (worker.columns[slot] == column) continue;
      worker.columns[slot] = column;
      if (worker.surfaces[slot].empty()) worker.surfaces[slot] = make_surface(correlator_.radius_px());
      const cv::Mat pixels =
          strip.centred_window({column * matrix_.stride_px, block_row * matrix_.stride_px, side, side});
      correlator_.forward(pixels, *worker.workspace, worker.block.data());
      correlator_.correlate(worker.block.data(), spectra_.of_block(column, block_row), on_map, *worker.workspace,
                            worker.surfaces[slot]);
    }
    RowSum& sum = row_sum(tile_column, block_row);
    if (sum.surface.empty()) sum.surface = make_surface(correlator_.radius_px());
    std::vector<const float*> rows(terms.size());
    for (int row = on_map.start; row < on_map.end; ++row) {
      std::transform(terms.begin(), terms.end(), rows.begin(),
                     [row](const cv::Mat* term) { return term->ptr<float>(row); });
      add_rows(rows, static_cast<std::size_t>(sum.surface.cols), sum.surface.ptr<float>(row));
    }
    sum.row = block_row;
  }
}

cv::Mat CleanSurfaces::surface(const MapStrip& strip, const SearchArea& area, std::int64_t tile_column,
                               std::int64_t tile_row, cv::Mat& scratch) const {
  scratch.create(area.lags.size(), CV_32F);
  const cv::Point tile(static_cast<int>(area.tile.col - strip.window.col),
                       static_cast<int>(area.tile.row - strip.window.row));
  // The sums of products come multiplied by the correlator's scale, and so must what is taken from them.
  const auto times = static_cast<float>(correlator_.scale());
  const float mean = times * strip.window_sum.at<float>(tile) / static_cast<float>(area.tile.width * area.tile.height);
  const float scale = strip.inverse_norm.at<float>(tile) / times;
  const int first_col = static_cast<int>(area.window.col - strip.window.col);
  const int first_row = static_cast<int>(area.window.row - strip.window.row);
  std::vector<const float*> terms(static_cast<std::size_t>(blocks_));
  const auto width = static_cast<std::size_t>(scratch.cols);
  for (int row = 0; row < scratch.rows; ++row) {
    for (int block = 0; block < blocks_; ++block) {
      terms[static_cast<std::size_t>(block)] =
          row_sum(tile_column, tile_row + block).surface.ptr<float>(area.lags.y + row) + area.lags.x;
    }
    float* out = scratch.ptr<float>(row);
    add_rows(terms, width, out);
    normalise(strip.window_sum.ptr<float>(first_row + row) + first_col,
              strip.inverse_norm.ptr<float>(first_row + row) + first_col, mean, scale, width, out);
  }
  return scratch;
}

DegradedSurfaces::DegradedSurfaces(const TileMatrix& matrix, int radius_px, std::int64_t first_column,
                                   std::int64_t columns, std::span<const Degrader> copies, int margin_px)
    : copies_(copies),
      margin_px_(margin_px),
      correlator_(matrix.tile_size_px, radius_px, matrix.stride_px),
      spectra_(correlator_, matrix.stride_px, first_column, columns) {}

std::size_t DegradedSurfaces::bytes_per_column(const TileMatrix& matrix, int radius_px) {
  return WindowSpectra::bytes_per_column({matrix.tile_size_px, radius_px, matrix.stride_px}, matrix.stride_px);
}

void DegradedSurfaces::prepare(const MapStrip& strip, std::int64_t tile_row, std::span<const std::int64_t> tile_columns,
                               int threads) {
  ensure_workspaces(workspaces_, correlator_, threads);
  while (blocks_.size() < workspaces_.size()) blocks_.emplace_back(correlator_.spectrum_size());
  spectra_.prepare(
      strip, tile_row,
      [&](std::int64_t column) { return std::binary_search(tile_columns.begin(), tile_columns.end(), column); },
      workspaces_, threads);
}

cv::Mat DegradedSurfaces::surface(const MapStrip& strip, const SearchArea& area, std::int64_t tile_column,
                                  std::int64_t tile_row, std::size_t copy, int worker, cv::Mat& scratch) {
  cv::Mat tile = degraded_tile(strip, area.tile, copies_[copy], margin_px_);
  tile -= cv::mean(tile)[0];
  const double norm = cv::norm(tile, cv::NORM_L2);
  if (!(norm > 0)) return {};
  AlignedFloats& block = blocks_[static_cast<std::size_t>(worker)];
  RealFft2d::Workspace& workspace = workspaces_[static_cast<std::size_t>(worker)];
  correlator_.forward(tile, workspace, block.data());
  scratch.create(2 * correlator_.radius_px() + 1, 2 * correlator_.radius_px() + 1, CV_32F);
  correlator_.correlate(block.data(), spectra_.of_block(tile_column, tile_row),
                        {area.lags.y, area.lags.y + area.lags.height}, workspace, scratch);

  cv::Mat surface = scratch(area.lags);
  const auto scale = static_cast<float>(1 / (norm * correlator_.scale()));
  const int first_col = static_cast<int>(area.window.col - strip.window.col);
  const int first_row = static_cast<int>(area.window.row - strip.window.row);
  for (int row = 0; row < surface.rows; ++row) {
    normalise(strip.window_sum.ptr<float>(first_row + row) + first_col,
              strip.inverse_norm.ptr<float>(first_row + row) + first_col, 0, scale,
              static_cast<std::size_t>(surface.cols), surface.ptr<float>(row));
  }
  return surface;
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
