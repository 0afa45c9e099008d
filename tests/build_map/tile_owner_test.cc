#include "pilotage/build_map/tile_owner.h"

#include <cmath>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

TileMatrix make_matrix(int size, int stride) {
  TileMatrix matrix;
  matrix.grid_width_px = 600;
  matrix.grid_height_px = 500;
  matrix.tile_size_px = size;
  matrix.stride_px = stride;
  return matrix;
}

bool contains(const TileMatrix& matrix, const TileCell& cell, double x, double y) {
  const PixelWindow window = matrix.tile_window(cell.column, cell.row);
  return x >= static_cast<double>(window.col) && x < static_cast<double>(window.col + window.width) &&
         y >= static_cast<double>(window.row) && y < static_cast<double>(window.row + window.height);
}

double distance(const TileMatrix& matrix, const TileCell& cell, double x, double y) {
  const PixelWindow window = matrix.tile_window(cell.column, cell.row);
  return std::max(std::abs(x - static_cast<double>(window.col) - matrix.tile_size_px / 2.0),
                  std::abs(y - static_cast<double>(window.row) - matrix.tile_size_px / 2.0));
}

// Every point inside a selected tile has exactly one owner: the nearest of all tiles that contain it.
TEST(TileOwner, IsTheNearestSelectedTileThatContainsThePoint) {
  Random random(seed_from_name("TileOwner"));
  for (const auto& [size, stride] :
       std::vector<std::pair<int, int>>{{64, 64}, {64, 32}, {100, 33}, {50, 49}, {40, 60}}) {
    const TileMatrix matrix = make_matrix(size, stride);
    std::vector<TileCell> selected;
    for (std::int64_t row = 0; row < matrix.matrix_height(); ++row) {
      for (std::int64_t column = 0; column < matrix.matrix_width(); ++column) {
        if (random.uniform() < 0.4) selected.push_back({column, row});
      }
    }
    const TileOwner owner(matrix, selected);
    for (int trial = 0; trial < 3000; ++trial) {
      const double x = trial % 2 == 0 ? random.uniform(0, 600) : static_cast<double>(random.below(600));
      const double y = trial % 2 == 0 ? random.uniform(0, 500) : static_cast<double>(random.below(500));
      const auto found = owner.owner_of(x, y);
      double nearest = INFINITY;
      for (const auto& cell : selected) {
        if (contains(matrix, cell, x, y)) nearest = std::min(nearest, distance(matrix, cell, x, y));
      }
      ASSERT_EQ(found.has_value(), std::isfinite(nearest)) << x << " " << y;
      if (!found) continue;
      EXPECT_TRUE(contains(matrix, *found, x, y));
      EXPECT_EQ(distance(matrix, *found, x, y), nearest);
    }
  }
}

}  // namespace
}  // namespace pilotage
