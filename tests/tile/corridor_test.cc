#include "pilotage/tile/corridor.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

TileMatrix make_matrix() {
  TileMatrix matrix;
  matrix.map_from_pixel = GeoTransform::north_up(1000, 5000, 0.5);
  matrix.grid_width_px = 4000;
  matrix.grid_height_px = 3000;
  matrix.tile_size_px = 256;
  matrix.stride_px = 128;
  return matrix;
}

Eigen::Vector2d center_of(const TileMatrix& matrix, std::int64_t column, std::int64_t row) {
  const double half = matrix.tile_size_px / 2.0;
  return matrix.map_from_pixel.map_from_pixel(
      {static_cast<double>(column * matrix.stride_px) + half, static_cast<double>(row * matrix.stride_px) + half});
}

// Every tile of the matrix against every segment, without any bounding box.
double brute_force_offset_m(const Eigen::Vector2d& center, const std::vector<std::vector<GridSample>>& runs) {
  double best = std::numeric_limits<double>::infinity();
  for (const auto& run : runs) {
    for (std::size_t i = 0; i + 1 < run.size(); ++i) {
      for (int step = 0; step <= 1000; ++step) {
        const double t = step / 1000.0;
        best = std::min(best, (center - ((1 - t) * run[i].point_m + t * run[i + 1].point_m)).norm());
      }
    }
  }
  return best;
}

TEST(CorridorTiles, AgreesWithBruteForceOverTheWholeMatrix) {
  const TileMatrix matrix = make_matrix();
  Random random(seed_from_name("CorridorTiles"));
  for (int trial = 0; trial < 10; ++trial) {
    std::vector<GridSample> run;
    for (int i = 0; i < 4; ++i) {
      run.push_back({{random.uniform(900, 3100), random.uniform(3400, 5100)}, 1000.0 * i});
    }
    const double half_width_m = random.uniform(20, 300);
    const auto tiles = corridor_tiles({run}, half_width_m, matrix);
    std::size_t expected = 0;
    std::size_t at = 0;
    for (std::int64_t row = 0; row < matrix.matrix_height(); ++row) {
      for (std::int64_t column = 0; column < matrix.matrix_width(); ++column) {
        const double offset_m = brute_force_offset_m(center_of(matrix, column, row), {run});
        if (std::abs(offset_m - half_width_m) < 3.0) {  // the oracle's steps are up to 2.8 m long
          if (at < tiles.size() && tiles[at].row == row && tiles[at].column == column) ++at, ++expected;
          continue;
        }
        if (offset_m > half_width_m) continue;
        ++expected;
        ASSERT_LT(at, tiles.size());
        EXPECT_EQ(tiles[at].row, row);
        EXPECT_EQ(tiles[at].column, column);
        EXPECT_NEAR(tiles[at].route_offset_m, offset_m, 3.0);
        ++at;
      }
    }
    EXPECT_EQ(tiles.size(), expected);
  }
}

TEST(CorridorTiles, NearestPassageCounts) {
  const TileMatrix matrix = make_matrix();
  const Eigen::Vector2d center = center_of(matrix, 5, 5);
  const std::vector<GridSample> run{{center + Eigen::Vector2d(-100, 30), 0},
                                    {center + Eigen::Vector2d(100, 30), 200},
                                    {center + Eigen::Vector2d(100, 10), 220},
                                    {center + Eigen::Vector2d(-100, 10), 420}};
  for (const auto& tile : corridor_tiles({run}, 40, matrix)) {
    if (tile.column != 5 || tile.row != 5) continue;
    EXPECT_NEAR(tile.route_offset_m, 10, 1e-9);
    EXPECT_NEAR(tile.route_distance_m, 320, 1e-9);
    return;
  }
  FAIL() << "the tile under the route is missing";
}

TEST(CorridorTiles, ARunOfOneSampleIsAPoint) {
  const TileMatrix matrix = make_matrix();
  const auto tiles = corridor_tiles({{{center_of(matrix, 3, 4), 7}}}, 1, matrix);
  ASSERT_EQ(tiles.size(), 1U);
  EXPECT_EQ(tiles[0].column, 3);
  EXPECT_EQ(tiles[0].row, 4);
  EXPECT_EQ(tiles[0].route_distance_m, 7);
}

TEST(CorridorTiles, OutsideTheMatrixIsEmpty) {
  EXPECT_TRUE(corridor_tiles({{{{1e6, 1e6}, 0}, {{1e6, 2e6}, 1}}}, 50, make_matrix()).empty());
  EXPECT_TRUE(corridor_tiles({}, 50, make_matrix()).empty());
}

}  // namespace
}  // namespace pilotage
