#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/score/map_strip.h"
#include "pilotage/score/window_spectra.h"
#include "pilotage/vision/degradation.h"
#include "pilotage/vision/fft_correlation.h"

namespace pilotage {

/// Where a tile is looked for.
struct SearchArea {
  PixelWindow tile;
  PixelWindow window;  ///< The tile's window grown by the radius, cut to the grid.
  cv::Point truth;     ///< The tile's place among the positions of the window.
  cv::Rect lags;       ///< The positions within a surface of all lags −radius … radius.

  SearchArea(const TileMatrix& matrix, std::int64_t column, std::int64_t row, int radius_px);
};

/// Surfaces of the tiles of a few columns, row by row, from the correlations of blocks: the sum of products of a tile
/// of n × n blocks is the sum of those of its blocks, and each block belongs to up to n × n tiles. n = 1 when tiles do
/// not overlap by whole blocks.
class CleanSurfaces {
 public:
  /// For tiles of columns [first_column, first_column + columns) of `matrix`.
  CleanSurfaces(const TileMatrix& matrix, int radius_px, std::int64_t first_column, std::int64_t columns);
  CleanSurfaces(const CleanSurfaces&) = delete;  // spectra_ refers to correlator_
  CleanSurfaces& operator=(const CleanSurfaces&) = delete;

  /// Computes what the tiles at `tile_columns` (ascending) of one row need.
  void prepare(const MapStrip& strip, std::int64_t tile_row, std::span<const std::int64_t> tile_columns, int threads);

  /// Normalised surface of a prepared tile whose search area is all valid and which is not flat; CV_32F, one element
  /// per position. The result lives in `scratch`.
  cv::Mat surface(const MapStrip& strip, const SearchArea& area, std::int64_t tile_column, std::int64_t tile_row,
                  cv::Mat& scratch) const;

  static std::size_t bytes_per_column(const TileMatrix& matrix, int radius_px);

 private:
  struct RowSum {  // sum over the n blocks of one row of blocks of a tile
    std::int64_t row = -1;
    cv::Mat surface;
  };
  struct Worker {
    RealFft2d::Workspace* workspace = nullptr;
    AlignedFloats block;
    std::vector<cv::Mat> surfaces;  // of the last n blocks
    std::vector<std::int64_t> columns;
  };
  RowSum& row_sum(std::int64_t column, std::int64_t block_row);
  const RowSum& row_sum(std::int64_t column, std::int64_t block_row) const;
  void prepare_block_row(const MapStrip& strip, std::int64_t block_row, const std::vector<std::int64_t>& tile_columns,
                         int threads);
  cv::Range rows_on_map(std::int64_t block_row) const;
  void add_up(const MapStrip& strip, std::int64_t block_row, std::span<const std::int64_t> tile_columns,
              Worker& worker);

  TileMatrix matrix_;
  int blocks_;  // n
  std::int64_t first_column_;
  std::int64_t columns_;
  BlockCorrelator correlator_;
  WindowSpectra spectra_;
  std::vector<RowSum> row_sums_;  // of the last n rows of blocks
  std::vector<RealFft2d::Workspace> workspaces_;
  std::vector<Worker> workers_;
};

/// Surfaces of degraded copies of tiles, row by row.
class DegradedSurfaces {
 public:
  DegradedSurfaces(const TileMatrix& matrix, int radius_px, std::int64_t first_column, std::int64_t columns,
                   std::span<const Degrader> copies, int margin_px);
  DegradedSurfaces(const DegradedSurfaces&) = delete;
  DegradedSurfaces& operator=(const DegradedSurfaces&) = delete;

  void prepare(const MapStrip& strip, std::int64_t tile_row, std::span<const std::int64_t> tile_columns, int threads);

  /// Normalised surface of one copy of a prepared tile whose search area is all valid; empty when the copy is flat.
  cv::Mat surface(const MapStrip& strip, const SearchArea& area, std::int64_t tile_column, std::int64_t tile_row,
                  std::size_t copy, int worker, cv::Mat& scratch);

  static std::size_t bytes_per_column(const TileMatrix& matrix, int radius_px);

 private:
  std::span<const Degrader> copies_;
  int margin_px_;
  BlockCorrelator correlator_;
  WindowSpectra spectra_;
  std::vector<RealFft2d::Workspace> workspaces_;
  std::vector<AlignedFloats> blocks_;  // per worker
};

/// A degraded copy of a tile, from its surroundings in the strip.
cv::Mat degraded_tile(const MapStrip& strip, const PixelWindow& tile, const Degrader& degrader, int margin_px);

}  // namespace pilotage
