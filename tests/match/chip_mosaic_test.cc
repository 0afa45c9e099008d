#include "pilotage/match/chip_mosaic.h"

#include <limits>

#include "mapdb/small_map.h"
#include "match/chip_scene.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/mapdb/chip_codec.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

constexpr int kStoredFactor = 2;

class ChipMosaicTest : public ::testing::Test {
 protected:
  testing::TemporaryFolder folder_;
  testing::SmallMap map_;
  cv::Mat ground_;  // of the whole of level 0, on the grid of chips

  // A map of 6 × 4 tiles whose chips, without loss, are pieces of ground_; the tile `missing` has none.
  explicit ChipMosaicTest() {
    testing::SmallMapOptions options;
    options.columns = 6;
    options.rows = 4;
    options.tile_size_px = 32;
    map_ = testing::make_small_map(options);
    map_.chips.clear();
    ground_ = testing::random_ground(6 * 32 / kStoredFactor, 4 * 32 / kStoredFactor, seed_from_name("ChipMosaic"));
    for (const MapTile& tile : map_.tiles) {
      if (tile.level != 0 || tile.tile_id == kMissing) continue;
      const int side = 32 / kStoredFactor;
      const cv::Rect piece(static_cast<int>(tile.column) * side, static_cast<int>(tile.row) * side, side, side);
      const ChipPicture picture{ground_(piece).clone(), cv::Mat(side, side, CV_8UC1, cv::Scalar(255)), kStoredFactor};
      map_.chips.push_back(encode_chip(picture, tile.tile_id, 0, tile.column * 32, tile.row * 32, 8));
    }
  }
  static constexpr std::int64_t kMissing = 8;  // column 2, row 1

  MapReader reader() {
    testing::write_map(folder_ / "map.gpkg", map_, true);
    return MapReader::open_unverified(folder_ / "map.gpkg");
  }
};

TEST_F(ChipMosaicTest, TheSizeOfAChipsPixelIsKnownBefore) {
  MapReader map = reader();
  EXPECT_EQ(chip_factor(map, 0, {100.5, 61}, 41), kStoredFactor);
  EXPECT_EQ(chip_factor(map, 0, {80, 48}, 10), 0) << "the tile without a chip";
  EXPECT_EQ(chip_factor(map, 0, {-900, 61}, 41), 0);
  EXPECT_THROW(chip_factor(map, 9, {100, 61}, 41), UsageError);
}

TEST_F(ChipMosaicTest, ShowsTheGroundAroundAPoint) {
  MapReader map = reader();
  const ChipMosaic mosaic = read_chip_mosaic(map, 0, {100.5, 61}, 41);  // 59.5 … 141.5 × 20 … 102
  EXPECT_EQ(mosaic.factor, kStoredFactor);
  EXPECT_EQ(mosaic.first_col_px, 58);
  EXPECT_EQ(mosaic.first_row_px, 20);
  ASSERT_EQ(mosaic.gray.size(), cv::Size(42, 41));
  EXPECT_TRUE(mosaic.level_from_mosaic({1, 2}).isApprox(Eigen::Vector2d(60, 24)));
  EXPECT_TRUE(mosaic.mosaic_from_level({60, 24}).isApprox(Eigen::Vector2d(1, 2)));
  const cv::Rect hole = cv::Rect(2 * 16 - 29, 16 - 10, 16, 16);  // the missing tile
  EXPECT_EQ(cv::countNonZero(mosaic.valid), 42 * 41 - 16 * 16);
  EXPECT_EQ(cv::countNonZero(mosaic.valid(hole)), 0);
  cv::Mat expected = ground_(cv::Rect(29, 10, 42, 41)).clone();
  expected(hole).setTo(0);
  EXPECT_EQ(cv::norm(mosaic.gray, expected, cv::NORM_INF), 0);
}

TEST_F(ChipMosaicTest, IsNotValidBeyondTheMap) {
  MapReader map = reader();
  const ChipMosaic mosaic = read_chip_mosaic(map, 0, {0, 0}, 20);
  ASSERT_EQ(mosaic.gray.size(), cv::Size(20, 20));
  EXPECT_EQ(mosaic.first_col_px, -20);
  EXPECT_EQ(cv::countNonZero(mosaic.valid), 100);
  EXPECT_EQ(cv::countNonZero(mosaic.valid(cv::Rect(10, 10, 10, 10))), 100);
  EXPECT_TRUE(read_chip_mosaic(map, 0, {5000, 5000}, 20).gray.empty());
  EXPECT_TRUE(read_chip_mosaic(map, 1, {10, 10}, 20).gray.empty()) << "a level without chips";
}

TEST_F(ChipMosaicTest, AMapWithoutChipsGivesNothing) {
  map_.header.chips = false;
  map_.chips.clear();
  MapReader map = reader();
  EXPECT_TRUE(read_chip_mosaic(map, 0, {100, 60}, 20).gray.empty());
}

TEST_F(ChipMosaicTest, RefusesWhatIsNotAPlaceOrTooLarge) {
  MapReader map = reader();
  EXPECT_THROW(read_chip_mosaic(map, 7, {100, 60}, 20), UsageError);
  EXPECT_THROW(read_chip_mosaic(map, 0, {kNaN, 60}, 20), UsageError);
  EXPECT_THROW(read_chip_mosaic(map, 0, {1e300, 60}, 20), UsageError);
  EXPECT_THROW(read_chip_mosaic(map, 0, {100, 60}, 0), UsageError);
  EXPECT_THROW(read_chip_mosaic(map, 0, {100, 60}, kNaN), UsageError);
  EXPECT_THROW(read_chip_mosaic(map, 0, {100, 60}, kMaxMosaicSidePx * kStoredFactor), UsageError);
  EXPECT_NO_THROW(read_chip_mosaic(map, 0, {100, 60}, 0.5 * kMaxMosaicSidePx * kStoredFactor));
}

TEST_F(ChipMosaicTest, NamesDamagedAndForeignChips) {
  const auto expect_error = [&](const std::string& message, const std::string& tile = "tile 9") {
    MapReader map = reader();
    try {
      read_chip_mosaic(map, 0, {100, 60}, 20);
      ADD_FAILURE() << message;
    } catch (const DataError& error) {
      EXPECT_THAT(error.what(), HasSubstr(message));
      EXPECT_THAT(error.what(), HasSubstr("map.gpkg: " + tile + ", level 0:"));
    }
  };
  MapChip& chip = map_.chips[8];  // tile 9: tile 8 has none
  ASSERT_EQ(chip.tile_id, 9);
  const MapChip good = chip;
  chip.data.pop_back();
  expect_error("chip ");
  chip = good;
  chip.encoding = "gray8+zlib";
  expect_error("has encoding");
  chip = good;
  ++chip.window.col;
  expect_error("is not in multiples of its factor");
  chip =
      encode_chip({cv::Mat(8, 8, CV_8UC1, cv::Scalar(9)), cv::Mat(8, 8, CV_8UC1, cv::Scalar(255)), 4}, 9, 0, 96, 32, 8);
  expect_error("another size than its neighbours'", "tile 15");  // tile 9 is nearer
}

}  // namespace
}  // namespace pilotage
