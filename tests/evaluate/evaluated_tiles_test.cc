#include "pilotage/evaluate/evaluated_tiles.h"

#include <algorithm>

#include "evaluate/scored_dates.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/ground/ground_of_rasters.h"

namespace pilotage {
namespace {

/// 10 × 10 tiles of 64 px every 32 px, 1 m/px, one of them without ground.
struct PlainGround {
  Ground ground;
  std::vector<TileScores> scores;

  LevelScores judged() const { return {ScoreTable(ground, scores), 0}; }
};

PlainGround plain_ground() {
  PlainGround plain;
  plain.ground.crs = Crs::from_user_input("EPSG:32633");
  plain.ground.levels.emplace_back();
  plain.ground.levels[0].matrix = {0, GeoTransform::north_up(500000, 5000000, 1), 352, 352, 64, 32};
  cut_all_tiles(plain.ground);
  plain.scores.resize(plain.ground.tiles.size());
  plain.scores[44].status = TileStatus::kTooLittleGround;
  return plain;
}

TEST(EvaluatedTiles, ChoosesEveryNthTileThatHasGround) {
  const PlainGround plain = plain_ground();
  EXPECT_EQ(choose_tiles(plain.judged(), 1, 0, 1).size(), 99U);
  const std::vector<std::size_t> every_second = choose_tiles(plain.judged(), 2, 0, 1);
  EXPECT_EQ(every_second.size(), 24U) << "25 but the one without ground";
  EXPECT_EQ(every_second[1], 2U);
  EXPECT_EQ(every_second[5], 20U);
}

TEST(EvaluatedTiles, FewerTilesAreASubsetOfMore) {
  const PlainGround plain = plain_ground();
  const auto ten = choose_tiles(plain.judged(), 1, 10, 7);
  const auto thirty = choose_tiles(plain.judged(), 1, 30, 7);
  EXPECT_EQ(ten.size(), 10U);
  EXPECT_EQ(thirty.size(), 30U);
  EXPECT_TRUE(std::is_sorted(thirty.begin(), thirty.end()));
  EXPECT_TRUE(std::includes(thirty.begin(), thirty.end(), ten.begin(), ten.end()));
  EXPECT_NE(ten, choose_tiles(plain.judged(), 1, 10, 8));
  EXPECT_EQ(choose_tiles(plain.judged(), 1, 1000, 7).size(), 99U);
}

TEST(EvaluatedTiles, BlocksAreSquaresOfGround) {
  const PlainGround plain = plain_ground();
  const auto block = [&](std::size_t tile) { return block_of(plain.judged(), plain.ground.tiles[tile], 128); };
  // Centres at 32, 64, 96 | 128, 160 …: three columns in the first block, four in the second.
  EXPECT_EQ(block(0), block(2));
  EXPECT_NE(block(2), block(3));
  EXPECT_EQ(block(3), block(6));
  EXPECT_EQ(block(0), block(20));
  EXPECT_NE(block(20), block(30));
  EXPECT_NE(block(3), block(30));
}

TEST(EvaluatedTiles, KnowsGroundLengthsAndCentres) {
  const PlainGround plain = plain_ground();
  EXPECT_NEAR(ground_gsd_m(plain.judged()), 1 / 0.9996, 1e-5) << "UTM on its central meridian";
  EXPECT_EQ(plain.judged().matrix().tile_center(plain.ground.tiles[11].cell()), Eigen::Vector2d(500064, 4999936));
}

TEST(EvaluatedTiles, AMapNeedsAGridInMetres) {
  PlainGround plain = plain_ground();
  const testing::TemporaryFolder folder;
  plain.ground.crs = Crs::wgs84();
  EXPECT_THROW(build_evaluation_map(folder / "map.gpkg", plain.judged(), false, 1, {}), UsageError);
  plain = plain_ground();
  plain.ground.levels[0].matrix.map_from_pixel.x_per_row = 0.1;
  EXPECT_THROW(build_evaluation_map(folder / "map.gpkg", plain.judged(), false, 1, {}), UsageError);
}

}  // namespace
}  // namespace pilotage
