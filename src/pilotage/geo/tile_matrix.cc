#include "pilotage/geo/tile_matrix.h"

#include <algorithm>

namespace pilotage {

PixelWindow TileMatrix::search_window(std::int64_t column, std::int64_t row, int radius_px) const {
  const PixelWindow tile = tile_window(column, row);
  const std::int64_t first_col = std::max<std::int64_t>(0, tile.col - radius_px);
  const std::int64_t first_row = std::max<std::int64_t>(0, tile.row - radius_px);
  const std::int64_t end_col = std::min(grid_width_px, tile.col + tile.width + radius_px);
  const std::int64_t end_row = std::min(grid_height_px, tile.row + tile.height + radius_px);
  return {first_col, first_row, static_cast<int>(end_col - first_col), static_cast<int>(end_row - first_row)};
}

}  // namespace pilotage
