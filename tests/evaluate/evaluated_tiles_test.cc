#include "pilotage/evaluate/evaluated_tiles.h"

#include <algorithm>

#include "evaluate/two_dates.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

/// 10 × 10 tiles of 64 px every 32 px, 1 m/px, one of them without ground.
ScoredGround plain_ground() {
  ScoredGround ground;
  ground.crs = Crs::from_user_input("EPSG:32633");
  ground.matrix = {0, GeoTransform::north_up(500000, 5000000, 1), 352, 352, 64, 32};
  for (std::int64_t i = 0; i < 100; ++i) {
    TileRow row;
    row.tile.tile_id = i;
    row.tile.column = i % 10;
    row.tile.row = i / 10;
    row.min_col_px = row.tile.column * 32;
    row.min_row_px = row.tile.row * 32;
    if (i == 44) row.score.status = TileStatus::kTooLittleGround;
    ground.rows.push_back(row);
  }
  return ground;
}

TEST(ScoredGround, ChoosesEveryNthTileThatHasGround) {
  const ScoredGround ground = plain_ground();
  EXPECT_EQ(choose_tiles(ground, 1, 0, 1).size(), 99U);
  const std::vector<std::size_t> every_second = choose_tiles(ground, 2, 0, 1);
  EXPECT_EQ(every_second.size(), 24U) << "25 but the one without ground";
  EXPECT_EQ(every_second[1], 2U);
  EXPECT_EQ(every_second[5], 20U);
}

TEST(ScoredGround, FewerTilesAreASubsetOfMore) {
  const ScoredGround ground = plain_ground();
  const auto ten = choose_tiles(ground, 1, 10, 7);
  const auto thirty = choose_tiles(ground, 1, 30, 7);
  EXPECT_EQ(ten.size(), 10U);
  EXPECT_EQ(thirty.size(), 30U);
  EXPECT_TRUE(std::is_sorted(thirty.begin(), thirty.end()));
  EXPECT_TRUE(std::includes(thirty.begin(), thirty.end(), ten.begin(), ten.end()));
  EXPECT_NE(ten, choose_tiles(ground, 1, 10, 8));
  EXPECT_EQ(choose_tiles(ground, 1, 1000, 7).size(), 99U);
}

TEST(ScoredGround, BlocksAreSquaresOfGround) {
  const ScoredGround ground = plain_ground();
  const auto block = [&](std::size_t row) { return block_of(ground, ground.rows[row], 128); };
  // Centres at 32, 64, 96 | 128, 160 …: three columns in the first block, four in the second.
  EXPECT_EQ(block(0), block(2));
  EXPECT_NE(block(2), block(3));
  EXPECT_EQ(block(3), block(6));
  EXPECT_EQ(block(0), block(20));
  EXPECT_NE(block(20), block(30));
  EXPECT_NE(block(3), block(30));
}

TEST(ScoredGround, KnowsGroundLengthsAndCentres) {
  const ScoredGround ground = plain_ground();
  EXPECT_NEAR(ground_gsd_m(ground), 1 / 0.9996, 1e-5) << "UTM on its central meridian";
  EXPECT_EQ(tile_center(ground, ground.rows[11]), Eigen::Vector2d(500064, 4999936));
}

TEST(ScoredGround, AMapNeedsAGridInMetres) {
  ScoredGround ground = plain_ground();
  const testing::TemporaryFolder folder;
  ground.crs = Crs::wgs84();
  EXPECT_THROW(build_evaluation_map(folder / "map.gpkg", ground, false, 1, {}), UsageError);
  ground = plain_ground();
  ground.matrix.map_from_pixel.x_per_row = 0.1;
  EXPECT_THROW(build_evaluation_map(folder / "map.gpkg", ground, false, 1, {}), UsageError);
}

}  // namespace
}  // namespace pilotage
