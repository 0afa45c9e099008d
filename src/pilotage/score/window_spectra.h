#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "pilotage/score/map_strip.h"
#include "pilotage/vision/fft_correlation.h"

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

  /// Makes all windows of the blocks of one row available; `needed(column)` says which blocks these are. `strip`
  /// must hold the blocks' surroundings as far as the map goes (what is beyond it counts as 0).
  void prepare(const MapStrip& strip, std::int64_t row, const std::function<bool(std::int64_t)>& needed,
               std::vector<RealFft2d::Workspace>& workspaces, int threads);

  /// Spectra of the parts of a prepared block, in BlockCorrelator's order.
  std::vector<const float*> of_block(std::int64_t column, std::int64_t row) const;

  /// Bytes kept per column of blocks.
  static std::size_t bytes_per_column(const BlockCorrelator& correlator, int stride_px);

 private:
  struct Slot {
    std::int64_t row = -1;
    AlignedFloats spectrum;
  };
  static int step(const BlockCorrelator& correlator, int stride_px);
  static int depth(const BlockCorrelator& correlator, int stride_px);
  std::size_t slot_index(std::int64_t column, std::int64_t row) const;

  const BlockCorrelator& correlator_;
  int stride_px_;
  int step_;   // windows from one part to the next
  int depth_;  // rows kept
  std::int64_t first_column_;
  std::int64_t columns_;  // of windows
  std::vector<Slot> slots_;
};

}  // namespace pilotage
