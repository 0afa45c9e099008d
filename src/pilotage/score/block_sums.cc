#include "pilotage/score/block_sums.h"

#include <algorithm>
#include <array>

#include "pilotage/correlation/correlation_kernels.h"

namespace pilotage {
namespace {

/// Tiles of more blocks than this along a side are not put together from blocks: the sums would cost more than they
/// save.
constexpr int kMostBlocks = 8;

BlockCorrelator make_correlator(const TileMatrix& matrix, int radius_px, int lag_step) {
  return {matrix.tile_size_px / BlockSums::blocks_per_side(matrix), radius_px, matrix.stride_px, lag_step};
}

cv::Mat make_surface(int radius) {
  return cv::Mat(2 * radius + 1, 2 * radius + 1, CV_32F);
}

/// out = terms[0] + … , in this order.
void add_rows(std::span<const float* const> terms, std::span<float> out) {
  if (terms.size() == 4) {  // the usual number, worth one pass
    add_four(terms[0], terms[1], terms[2], terms[3], out.size(), out.data());
    return;
  }
  std::copy(terms[0], terms[0] + out.size(), out.begin());
  for (const float* term : terms.subspan(1)) add_to(term, out.size(), out.data());
}

}  // namespace

int BlockSums::blocks_per_side(const TileMatrix& matrix) {
  const int blocks = matrix.stride_px > 0 ? matrix.tile_size_px / matrix.stride_px : 1;
  return matrix.tile_size_px % matrix.stride_px == 0 && blocks <= kMostBlocks ? std::max(1, blocks) : 1;
}

BlockSums::BlockSums(const TileMatrix& matrix, int radius_px, int lag_step, std::int64_t first_column,
                     std::int64_t columns)
    : matrix_(matrix),
      blocks_(blocks_per_side(matrix)),
      first_column_(first_column),
      columns_(columns),
      correlator_(make_correlator(matrix, radius_px, lag_step)),
      spectra_(correlator_, matrix.stride_px, first_column, columns + blocks_ - 1),
      row_sums_(static_cast<std::size_t>(columns * blocks_)),
      workspace_(correlator_.make_workspace()),
      block_(correlator_.spectrum_size()),
      block_surfaces_(static_cast<std::size_t>(blocks_)) {
  for (cv::Mat& surface : block_surfaces_) surface = make_surface(radius());
}

std::size_t BlockSums::bytes_per_column(const TileMatrix& matrix, int radius_px, int lag_step) {
  const BlockCorrelator correlator = make_correlator(matrix, radius_px, lag_step);
  const auto side = static_cast<std::size_t>(2 * correlator.radius() + 1);
  return static_cast<std::size_t>(blocks_per_side(matrix)) * side * side * sizeof(float) +
         WindowSpectra::bytes_per_column(correlator, matrix.stride_px);
}

BlockSums::RowSum& BlockSums::row_sum(std::int64_t column, std::int64_t block_row) {
  return row_sums_[static_cast<std::size_t>(block_row % blocks_ * columns_ + column - first_column_)];
}
const BlockSums::RowSum& BlockSums::row_sum(std::int64_t column, std::int64_t block_row) const {
  return row_sums_[static_cast<std::size_t>(block_row % blocks_ * columns_ + column - first_column_)];
}

void BlockSums::prepare(const MapStrip& strip, std::int64_t tile_row, std::span<const std::int64_t> tile_columns) {
  for (std::int64_t block_row = tile_row; block_row < tile_row + blocks_; ++block_row) {
    std::vector<std::int64_t> missing;
    for (const std::int64_t column : tile_columns) {
      if (row_sum(column, block_row).row != block_row) missing.push_back(column);
    }
    add_up(strip, block_row, missing);
  }
}

/// Rows of the surfaces of a row of blocks that are positions on the map for any tile the blocks belong to.
cv::Range BlockSums::rows_on_map(std::int64_t block_row) const {
  const std::int64_t radius = correlator_.radius();
  const std::int64_t top = block_row * matrix_.stride_px;                  // of the lowest of these tiles
  const std::int64_t upper_top = top - (blocks_ - 1) * matrix_.stride_px;  // and of the highest
  const std::int64_t room = matrix_.grid_height_px - matrix_.tile_size_px - upper_top;
  return {static_cast<int>(radius - std::min(radius, top / lag_step())),
          static_cast<int>(radius + std::clamp<std::int64_t>(room / lag_step(), 0, radius) + 1)};
}

void BlockSums::add_up(const MapStrip& strip, std::int64_t block_row, std::span<const std::int64_t> tile_columns) {
  const int side = correlator_.block_px();
  const cv::Range on_map = rows_on_map(block_row);
  std::vector<std::int64_t> computed(static_cast<std::size_t>(blocks_), -1);  // columns in block_surfaces_
  for (const std::int64_t tile_column : tile_columns) {
    std::vector<const cv::Mat*> terms;
    for (std::int64_t column = tile_column; column < tile_column + blocks_; ++column) {
      const auto slot = static_cast<std::size_t>(column % blocks_);
      terms.push_back(&block_surfaces_[slot]);
      if (computed[slot] == column) continue;
      computed[slot] = column;
      const PixelWindow block{column * matrix_.stride_px, block_row * matrix_.stride_px, side, side};
      correlator_.forward(strip.components_of(block, lag_step()), workspace_, block_.data());
      const std::array<const float*, 1> spectra{block_.data()};
      correlator_.correlate(spectra, spectra_.of_block(strip, column, block_row), on_map, {&workspace_, 1},
                            {&block_surfaces_[slot], 1});
    }
    RowSum& sum = row_sum(tile_column, block_row);
    if (sum.surface.empty()) sum.surface = make_surface(radius());
    std::vector<const float*> rows(terms.size());
    for (int row = on_map.start; row < on_map.end; ++row) {
      std::transform(terms.begin(), terms.end(), rows.begin(),
                     [row](const cv::Mat* term) { return term->ptr<float>(row); });
      add_rows(rows, {sum.surface.ptr<float>(row), static_cast<std::size_t>(sum.surface.cols)});
    }
    sum.row = block_row;
  }
}

void BlockSums::row(std::int64_t tile_column, std::int64_t tile_row, int lag_col, int lag_row,
                    std::span<float> out) const {
  std::array<const float*, kMostBlocks> terms{};
  const auto count = static_cast<std::size_t>(blocks_);
  for (std::size_t block = 0; block < count; ++block) {
    terms[block] =
        row_sum(tile_column, tile_row + static_cast<std::int64_t>(block)).surface.ptr<float>(lag_row) + lag_col;
  }
  add_rows(std::span(terms).first(count), out);
}

}  // namespace pilotage
