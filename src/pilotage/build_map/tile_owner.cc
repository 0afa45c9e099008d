#include "pilotage/build_map/tile_owner.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pilotage {

TileOwner::TileOwner(const TileMatrix& matrix, const std::vector<TileCell>& selected) : matrix_(matrix) {
  for (const TileCell& cell : selected) selected_.insert(matrix.index_of(cell.column, cell.row));
}

std::optional<TileCell> TileOwner::owner_of(double x_px, double y_px) const {
  const double stride = matrix_.stride_px;
  const double size = matrix_.tile_size_px;
  // Tiles that contain a coordinate v: index·stride ≤ v < index·stride + size.
  const auto first = [&](double v) {
    return std::max<std::int64_t>(0, static_cast<std::int64_t>(std::floor((v - size) / stride)) + 1);
  };
  const auto last = [&](double v) { return static_cast<std::int64_t>(std::floor(v / stride)); };

  std::optional<TileCell> owner;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::int64_t row = first(y_px); row <= std::min(last(y_px), matrix_.matrix_height() - 1); ++row) {
    for (std::int64_t column = first(x_px); column <= std::min(last(x_px), matrix_.matrix_width() - 1); ++column) {
      if (!selected_.contains(matrix_.index_of(column, row))) continue;
      const double distance = std::max(std::abs(x_px - (static_cast<double>(column) * stride + size / 2)),
                                       std::abs(y_px - (static_cast<double>(row) * stride + size / 2)));
      if (distance < nearest) {
        nearest = distance;
        owner = TileCell{column, row};
      }
    }
  }
  return owner;
}

}  // namespace pilotage
