#pragma once

#include <cstdint>
#include <optional>
#include <unordered_set>
#include <vector>

#include "pilotage/geo/tile_matrix.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Which selected tile stores a piece of ground: among the selected tiles of one level that contain the point, the one
/// whose centre is nearest (Chebyshev distance; the lower row, then the lower column on a tie). So the stored cells of
/// overlapping tiles do not overlap and together cover the union of their footprints.
class TileOwner {
 public:
  TileOwner(const TileMatrix& matrix, const std::vector<TileCell>& selected);

  /// The tile that stores the pixel position, or nothing outside all selected tiles. A tile contains its left and upper
  /// edge, not its right and lower one.
  std::optional<TileCell> owner_of(double x_px, double y_px) const;

 private:
  TileMatrix matrix_;
  std::unordered_set<std::int64_t> selected_;  // row · matrix_width + column
};

}  // namespace pilotage

#pragma GCC visibility pop
