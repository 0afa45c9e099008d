#pragma once

#include <cstddef>
#include <cstdint>

#include "pilotage/geo/bounds.h"
#include "pilotage/geo/geo_transform.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A rectangle of whole pixels.
struct PixelWindow {
  std::int64_t col = 0;  ///< First column.
  std::int64_t row = 0;  ///< First row.
  int width = 0;
  int height = 0;

  bool operator==(const PixelWindow&) const = default;
};

/// Most levels of a plan or a map; numbers of tiles are made for as many.
inline constexpr std::size_t kMaxLevels = 64;

/// A tile's place in a tile matrix.
struct TileCell {
  std::int64_t column = 0;
  std::int64_t row = 0;

  bool operator==(const TileCell&) const = default;
};

/// One level of tiles over a pixel grid, in the words of OGC 17-083r4 (Two Dimensional Tile Matrix Set): point of
/// origin at the top left, columns to the right, rows downwards. Unlike a TileMatrixSet, neighbouring tiles overlap
/// when stride_px < tile_size_px. Tiles are square; each lies wholly inside the grid.
struct TileMatrix {
  int level = 0;  ///< tileMatrix identifier: 0 is the finest.
  GeoTransform map_from_pixel;
  std::int64_t grid_width_px = 0;
  std::int64_t grid_height_px = 0;
  int tile_size_px = 0;
  int stride_px = 0;

  /// Number of tile columns; 0 when the grid is narrower than a tile.
  std::int64_t matrix_width() const { return count(grid_width_px); }
  std::int64_t matrix_height() const { return count(grid_height_px); }
  std::int64_t tile_count() const { return matrix_width() * matrix_height(); }

  /// Number of a tile, row by row: 0 … tile_count() − 1; cell_of is its inverse.
  std::int64_t index_of(std::int64_t column, std::int64_t row) const { return row * matrix_width() + column; }
  TileCell cell_of(std::int64_t index) const { return {index % matrix_width(), index / matrix_width()}; }
  bool contains(std::int64_t column, std::int64_t row) const {
    return column >= 0 && row >= 0 && column < matrix_width() && row < matrix_height();
  }

  PixelWindow tile_window(std::int64_t column, std::int64_t row) const {
    return {column * stride_px, row * stride_px, tile_size_px, tile_size_px};
  }

  PixelWindow tile_window(const TileCell& cell) const { return tile_window(cell.column, cell.row); }

  /// The centre of a tile and the rectangle around it, along the axes and in the units of the CRS.
  Eigen::Vector2d tile_center(const TileCell& cell) const;
  Bounds tile_bounds(const TileCell& cell) const;

  /// The grid whose pixels are the cells of one stride around the centres of the tiles, so that neighbouring tiles,
  /// which overlap, are drawn side by side; its first pixel belongs to the tile named.
  GeoTransform map_from_stride_cell(const TileCell& first) const;

  /// The search area of a tile: its window grown by `radius_px` on each side and cut to the grid.
  PixelWindow search_window(std::int64_t column, std::int64_t row, int radius_px) const;
  PixelWindow search_window(const TileCell& cell, int radius_px) const {
    return search_window(cell.column, cell.row, radius_px);
  }

 private:
  std::int64_t count(std::int64_t extent_px) const {
    return extent_px < tile_size_px ? 0 : (extent_px - tile_size_px) / stride_px + 1;
  }
};

}  // namespace pilotage

#pragma GCC visibility pop
