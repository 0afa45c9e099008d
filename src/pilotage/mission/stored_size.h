#pragma once

#include <vector>

#pragma GCC visibility push(default)

namespace pilotage {

/// The most bytes that stored ground can take in the map database; `select` holds the budget against these, so that a
/// map never exceeds it.
struct StoredSize {
  double bytes_per_px = 0;    ///< Descriptors and key points, per pixel of a level.
  double bytes_per_tile = 0;  ///< A row of the tiles layer with its scores, index entries and unused ends of pages.
  double bytes_fixed = 0;     ///< Everything that does not depend on the tiles.
  /// Chips, per pixel of each level of the plan; empty without chips.
  std::vector<double> chip_bytes_per_px{};
};

}  // namespace pilotage

#pragma GCC visibility pop
