#include "pilotage/geo/tile_matrix.h"

#include <cmath>

#include <gmock/gmock.h>

namespace pilotage {
namespace {

TileMatrix matrix_over(const GeoTransform& map_from_pixel) {
  return {0, map_from_pixel, 1000, 700, 100, 40};
}

TEST(TileMatrix, NumbersTilesRowByRowAndBack) {
  const TileMatrix matrix = matrix_over(GeoTransform::north_up(0, 0, 1));
  ASSERT_EQ(matrix.matrix_width(), 23);
  ASSERT_EQ(matrix.matrix_height(), 16);
  std::int64_t index = 0;
  for (std::int64_t row = 0; row < matrix.matrix_height(); ++row) {
    for (std::int64_t column = 0; column < matrix.matrix_width(); ++column, ++index) {
      ASSERT_EQ(matrix.index_of(column, row), index);
      ASSERT_EQ(matrix.cell_of(index), (TileCell{column, row}));
      ASSERT_TRUE(matrix.contains(column, row));
    }
  }
  EXPECT_EQ(index, matrix.tile_count());
}

TEST(TileMatrix, ContainsNoTileBeyondItsEdges) {
  const TileMatrix matrix = matrix_over(GeoTransform::north_up(0, 0, 1));
  EXPECT_FALSE(matrix.contains(-1, 0));
  EXPECT_FALSE(matrix.contains(0, -1));
  EXPECT_FALSE(matrix.contains(matrix.matrix_width(), 0));
  EXPECT_FALSE(matrix.contains(0, matrix.matrix_height()));
}

TEST(TileMatrix, PutsBoundsAndCentreOnTheGround) {
  const TileMatrix matrix = matrix_over(GeoTransform::north_up(5000, 9000, 0.5));
  const Bounds bounds = matrix.tile_bounds({2, 3});
  EXPECT_EQ(bounds.min_x_m, 5000 + 80 * 0.5);
  EXPECT_EQ(bounds.max_x_m, 5000 + 180 * 0.5);
  EXPECT_EQ(bounds.max_y_m, 9000 - 120 * 0.5);
  EXPECT_EQ(bounds.min_y_m, 9000 - 220 * 0.5);
  EXPECT_EQ(matrix.tile_center({2, 3}), bounds.center_m());
}

TEST(TileMatrix, DrawsTheRectangleAroundATileOfARotatedGrid) {
  const double c = std::cos(0.5);
  const double s = std::sin(0.5);
  const TileMatrix matrix = matrix_over({100, c, s, 200, s, -c});
  const Bounds bounds = matrix.tile_bounds({0, 0});
  EXPECT_NEAR(bounds.width_m(), 100 * (c + s), 1e-9);
  EXPECT_NEAR(bounds.height_m(), 100 * (c + s), 1e-9);
}

TEST(TileMatrix, DrawsOverlappingTilesAsNeighbouringCells) {
  const TileMatrix matrix = matrix_over(GeoTransform::north_up(0, 0, 2));
  const GeoTransform cells = matrix.map_from_stride_cell({3, 4});
  for (const TileCell& cell : {TileCell{3, 4}, TileCell{5, 9}}) {
    const Eigen::Vector2d middle(static_cast<double>(cell.column - 3) + 0.5, static_cast<double>(cell.row - 4) + 0.5);
    EXPECT_TRUE(cells.map_from_pixel(middle).isApprox(matrix.tile_center(cell), 1e-12));
  }
  EXPECT_EQ(cells.x_per_col, 80);
}

}  // namespace
}  // namespace pilotage
