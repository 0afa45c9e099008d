#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/correlation/fft_correlation.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/score/map_strip.h"
#include "pilotage/score/window_spectra.h"

namespace pilotage {

/// Sums of products of tiles with the map around them, Σ_u f(u)·f(u + lag) with f the map minus its centre, for the
/// tiles of a few columns, row by row: the sum of a tile of n × n blocks is that of its blocks, and each block belongs
/// to up to n × n tiles. n = 1 when tiles do not overlap by whole blocks. For one thread.
class BlockSums {
 public:
  /// For tiles of columns [first_column, first_column + columns) of `matrix`, at the lags that BlockCorrelator has for
  /// this radius and lag_step.
  BlockSums(const TileMatrix& matrix, int radius_px, int lag_step, std::int64_t first_column, std::int64_t columns);
  BlockSums(const BlockSums&) = delete;  // spectra_ refers to correlator_
  BlockSums& operator=(const BlockSums&) = delete;

  /// Computes what the tiles at `tile_columns` (ascending) of one row need.
  void prepare(const MapStrip& strip, std::int64_t tile_row, std::span<const std::int64_t> tile_columns);

  /// One row of a prepared tile's sums, times scale(), for lags −radius() + (lag_col, lag_row) and what follows to the
  /// right.
  void row(std::int64_t tile_column, std::int64_t tile_row, int lag_col, int lag_row, std::span<float> out) const;

  /// Lags to each side, lag_step() pixels apart.
  int radius() const { return correlator_.radius(); }
  int lag_step() const { return correlator_.lag_step(); }
  double scale() const { return correlator_.scale(); }

  /// n for the tiles of a matrix.
  static int blocks_per_side(const TileMatrix& matrix);
  static std::size_t bytes_per_column(const TileMatrix& matrix, int radius_px, int lag_step);

 private:
  struct RowSum {  // sum over the n blocks of one row of blocks of a tile
    std::int64_t row = -1;
    cv::Mat surface;
  };
  RowSum& row_sum(std::int64_t column, std::int64_t block_row);
  const RowSum& row_sum(std::int64_t column, std::int64_t block_row) const;
  void add_up(const MapStrip& strip, std::int64_t block_row, std::span<const std::int64_t> tile_columns);
  cv::Range rows_on_map(std::int64_t block_row) const;

  TileMatrix matrix_;
  int blocks_;  // n
  std::int64_t first_column_;
  std::int64_t columns_;
  BlockCorrelator correlator_;
  WindowSpectra spectra_;
  std::vector<RowSum> row_sums_;  // of the last n rows of blocks
  RealFft2d::Workspace workspace_;
  AlignedFloats block_;                  // spectra of a block
  std::vector<cv::Mat> block_surfaces_;  // of n neighbouring blocks
};

}  // namespace pilotage
