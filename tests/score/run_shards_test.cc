#include "pilotage/score/run_shards.h"

#include <algorithm>
#include <set>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A matrix of width x height tiles.
TileMatrix matrix_of_tiles(std::int64_t width, std::int64_t height, int level = 0) {
  return {level, {}, 8 * (width - 1) + 16, 8 * (height - 1) + 16, 16, 8};
}

TEST(RunShards, HoldEachTileOnceInTheOrderOfWork) {
  for (const auto& [width, height, count] :
       {std::tuple{1, 1, 1}, {5, 4, 3}, {64, 7, 5}, {65, 7, 6}, {200, 30, 7}, {129, 2, 258}, {3, 100, 300}}) {
    const TileMatrix matrix = matrix_of_tiles(width, height);
    std::vector<ShardTile> all;
    std::size_t smallest = all.max_size();
    std::size_t largest = 0;
    for (std::int64_t number = 1; number <= count; ++number) {
      const std::vector<ShardTile> tiles = shard_tiles(matrix, {number, count});
      smallest = std::min(smallest, tiles.size());
      largest = std::max(largest, tiles.size());
      all.insert(all.end(), tiles.begin(), tiles.end());
    }
    EXPECT_LE(largest - smallest, 1U);
    const auto key = [](const ShardTile& tile) {
      return std::tuple(tile.column / kShardColumns, tile.row, tile.column);
    };
    EXPECT_TRUE(std::is_sorted(all.begin(), all.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); }));
    std::set<std::int64_t> places;
    for (const ShardTile& tile : all) {
      EXPECT_EQ(tile.place, tile.row * width + tile.column);
      places.insert(tile.place);
    }
    EXPECT_EQ(static_cast<std::int64_t>(places.size()), width * height);
    EXPECT_EQ(all.size(), places.size());
  }
}

TEST(RunShards, CutAPlanOfAllTilesLikeTheMatrix) {
  const TileMatrix matrix = matrix_of_tiles(150, 20);
  std::vector<GroundTile> plan;
  for (std::int64_t row = 0; row < 20; ++row) {
    for (std::int64_t column = 0; column < 150; ++column) {
      GroundTile tile;
      tile.tile_id = row * 150 + column;
      tile.column = column;
      tile.row = row;
      plan.push_back(tile);
    }
  }
  for (std::int64_t number = 1; number <= 11; ++number) {
    EXPECT_EQ(shard_tiles(plan, {number, 11}), shard_tiles(matrix, {number, 11}));
  }
}

TEST(RunShards, CutAPlanLevelByLevel) {
  std::vector<GroundTile> plan;
  for (int level = 0; level < 3; ++level) {
    for (std::int64_t column = 0; column < 10; ++column) {
      GroundTile tile;
      tile.tile_id = static_cast<std::int64_t>(plan.size());
      tile.level = level;
      tile.column = 7 * column;
      plan.push_back(tile);
    }
  }
  const std::vector<ShardTile> second = shard_tiles(plan, {2, 2});
  ASSERT_EQ(second.size(), 15U);
  EXPECT_EQ(second.front(), (ShardTile{15, 1, 35, 0}));
  const std::vector<ShardPart> parts = shard_parts(second);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].level, 1);
  EXPECT_EQ(parts[0].tiles, 5);
  EXPECT_EQ(parts[1].first_column, 0);
  EXPECT_EQ(parts[1].last_column, 63);
}

TEST(RunShards, PartsAreTheRectanglesAroundTheTiles) {
  const std::vector<ShardPart> parts = shard_parts(shard_tiles(matrix_of_tiles(100, 10), {2, 3}));  // ranks 333 … 665
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_THAT((std::vector{parts[0].first_column, parts[0].last_column, parts[0].first_row, parts[0].last_row}),
              ElementsAre(0, 63, 5, 9));
  EXPECT_THAT((std::vector{parts[1].first_column, parts[1].last_column, parts[1].first_row, parts[1].last_row}),
              ElementsAre(64, 89, 0, 0));
  EXPECT_EQ(parts[0].tiles, 640 - 333);
  EXPECT_EQ(parts[1].tiles, 666 - 640);
}

TEST(RunShards, HugeMatricesDoNotOverflow) {
  const TileMatrix matrix = matrix_of_tiles(30'000'000, 30'000'000);  // 9e14 tiles
  const std::vector<ShardTile> first = shard_tiles(matrix_of_tiles(3'000'000, 300), {1'000'000, 1'000'000});
  EXPECT_EQ(first.back().place, 3'000'000LL * 300 - 1);
  EXPECT_EQ(first.size(), 900U);
  EXPECT_EQ(matrix.tile_count(), 900'000'000'000'000LL);
}

TEST(RunShards, RefuseMoreShardsThanTiles) {
  EXPECT_THAT(
      [] {
        shard_tiles(matrix_of_tiles(2, 2), {1, 5});
      },
      ThrowsMessage<UsageError>(HasSubstr("5 shards of 4 tiles")));
  EXPECT_THROW(shard_tiles(matrix_of_tiles(2, 2), {3, 2}), UsageError);
  EXPECT_THROW(shard_tiles(std::vector<GroundTile>{}, {1, 1}), UsageError);
}

}  // namespace
}  // namespace pilotage
