#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/correlation/correlation_peaks.h"
#include "pilotage/correlation/fft_correlation.h"
#include "pilotage/degradation/degradation.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/score/block_sums.h"
#include "pilotage/score/map_strip.h"
#include "pilotage/score/window_spectra.h"

namespace pilotage {

/// Where a tile is looked for.
struct SearchArea {
  PixelWindow tile;
  PixelWindow window;  ///< The tile's window grown by the radius, cut to the grid.
  cv::Point truth;     ///< The tile's place among the positions of the window.
  cv::Size positions;  ///< Places where the tile fits into the window.

  SearchArea(const TileMatrix& matrix, std::int64_t column, std::int64_t row, int radius_px);
};

/// Which lags of clean surfaces are computed: all (1), or every second or fourth and what sparse_correlation_peaks()
/// asks for.
int choose_lag_step(const MapSample& sample, int tile_size_px, int radius_px);

/// Memory for the surfaces of one tile.
struct SurfaceScratch {
  cv::Mat surface;
  cv::Mat near;
};

/// Peaks of the surfaces of the tiles of a few columns, row by row. For one thread.
class CleanSurfaces {
 public:
  /// For tiles of columns [first_column, first_column + columns) of `matrix`.
  CleanSurfaces(const TileMatrix& matrix, int radius_px, int lag_step, std::int64_t first_column, std::int64_t columns);

  /// Computes what the tiles at `tile_columns` (ascending) of one row need.
  void prepare(const MapStrip& strip, std::int64_t tile_row, std::span<const std::int64_t> tile_columns);

  /// Peaks of a prepared tile whose search area is all valid and which is not flat.
  CorrelationPeaks peaks(const MapStrip& strip, const SearchArea& area, std::int64_t tile_column, std::int64_t tile_row,
                         SurfaceScratch& scratch) const;

  static std::size_t bytes_per_column(const TileMatrix& matrix, int radius_px, int lag_step);

 private:
  cv::Mat normalised(const BlockSums& sums, const MapStrip& strip, const SearchArea& area, std::int64_t tile_column,
                     std::int64_t tile_row, cv::Mat& scratch) const;

  BlockSums sums_;
  std::optional<BlockSums> near_;  // every lag, when sums_ has not
};

/// Peaks of the surfaces of degraded copies of tiles, row by row, at every lag: the copies of a tile share the map's
/// windows, but not their blocks, so that a lattice of lags would save little. For one thread.
class DegradedSurfaces {
 public:
  DegradedSurfaces(const TileMatrix& matrix, int radius_px, std::int64_t first_column, std::int64_t columns,
                   std::span<const Degrader> copies, int margin_px);
  DegradedSurfaces(const DegradedSurfaces&) = delete;  // windows_ refers to correlator_
  DegradedSurfaces& operator=(const DegradedSurfaces&) = delete;

  /// Peaks of each copy of a tile whose search area is all valid; nothing for a copy that is flat.
  std::vector<std::optional<CorrelationPeaks>> peaks(const MapStrip& strip, const SearchArea& area,
                                                     std::int64_t tile_column, std::int64_t tile_row);

  static std::size_t bytes_per_column(const TileMatrix& matrix, int radius_px);

 private:
  std::span<const Degrader> copies_;
  int margin_px_;
  BlockCorrelator correlator_;
  WindowSpectra windows_;
  std::vector<RealFft2d::Workspace> workspaces_;  // of each copy, as what follows
  std::vector<AlignedFloats> spectra_;
  std::vector<cv::Mat> surfaces_;
};

/// A degraded copy of a tile, from its surroundings in the strip.
cv::Mat degraded_tile(const MapStrip& strip, const PixelWindow& tile, const Degrader& degrader, int margin_px);

}  // namespace pilotage
