#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pilotage/correlation/fft_correlation.h"
#include "pilotage/score/map_strip.h"

namespace pilotage {

/// The transforms of the map windows that the blocks of a few neighbouring rows share (BlockCorrelator): computed once,
/// kept while the rows that need them are worked on, and forgotten as newer rows take their place.
///
/// Blocks stand on a grid: block (column, row) has its first pixel at (column, row)·stride. Window (column, row) has it
/// radius further up and left.
class WindowSpectra {
 public:
  /// For blocks of columns [first_column, first_column + columns).
  WindowSpectra(const BlockCorrelator& correlator, int stride_px, std::int64_t first_column, std::int64_t columns);

  /// Spectra of the parts of a block, in BlockCorrelator's order, valid until the next call; those that are not there
  /// yet are computed. `strip` must hold the block's surroundings as far as the map goes (what is beyond it counts as
  /// 0).
  std::span<const float* const> of_block(const MapStrip& strip, std::int64_t column, std::int64_t row);

  /// Bytes kept per column of blocks.
  static std::size_t bytes_per_column(const BlockCorrelator& correlator, int stride_px);

 private:
  static int step(const BlockCorrelator& correlator, int stride_px);
  static int depth(const BlockCorrelator& correlator, int stride_px);
  const float* window(const MapStrip& strip, std::int64_t column, std::int64_t row);

  const BlockCorrelator& correlator_;
  int stride_px_;
  int step_;   // windows from one part to the next
  int depth_;  // rows kept
  std::int64_t first_column_;
  std::int64_t columns_;            // of windows
  std::vector<std::int64_t> rows_;  // of the window in each slot, -1 = none
  AlignedFloats spectra_;           // of the slots, one after the other
  RealFft2d::Workspace workspace_;
  std::vector<const float*> of_block_;
};

}  // namespace pilotage
