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

Eigen::Vector2d TileMatrix::tile_center(const TileCell& cell) const {
  const PixelWindow window = tile_window(cell);
  return map_from_pixel.map_from_pixel(
      {static_cast<double>(window.col) + window.width / 2.0, static_cast<double>(window.row) + window.height / 2.0});
}

Bounds TileMatrix::tile_bounds(const TileCell& cell) const {
  const PixelWindow window = tile_window(cell);
  Bounds bounds;
  for (const int down_px : {0, window.height}) {
    for (const int right_px : {0, window.width}) {
      bounds.extend(map_from_pixel.map_from_pixel(
          {static_cast<double>(window.col + right_px), static_cast<double>(window.row + down_px)}));
    }
  }
  return bounds;
}

GeoTransform TileMatrix::map_from_stride_cell(const TileCell& first) const {
  const double inset_px = (tile_size_px - stride_px) / 2.0;
  GeoTransform transform = map_from_pixel.shifted(static_cast<double>(first.column * stride_px) + inset_px,
                                                  static_cast<double>(first.row * stride_px) + inset_px);
  transform.x_per_col *= stride_px;
  transform.x_per_row *= stride_px;
  transform.y_per_col *= stride_px;
  transform.y_per_row *= stride_px;
  return transform;
}

}  // namespace pilotage
