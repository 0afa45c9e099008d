#include "pilotage/mapdb/tile_cache.h"

#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {
namespace {

/// Descriptors of `count` features of the tile.
TileDescriptors row_of(std::int64_t tile_id, std::size_t count) {
  TileDescriptors row;
  row.tile_id = tile_id;
  row.features.features.resize(count);
  row.features.descriptors.resize(32 * count);
  return row;
}

/// A cache whose misses are counted.
struct Counted {
  explicit Counted(std::size_t max_bytes) : cache(max_bytes) {}

  std::shared_ptr<const TileDescriptors> get(std::int64_t tile_id, int level = 0) {
    return cache.get<TileDescriptors>(tile_id, level, [&]() -> std::optional<TileDescriptors> {
      ++reads;
      return row_of(tile_id, 100);
    });
  }
  /// Whether the row was held.
  bool held(std::int64_t tile_id) {
    const int before = reads;
    get(tile_id);
    return reads == before;
  }

  TileCache cache;
  int reads = 0;
};

std::size_t bytes_of_one() {
  Counted counted(std::size_t{1} << 20);
  counted.get(0);
  return counted.cache.bytes();
}

TEST(TileCache, ReadsARowOnce) {
  Counted counted(std::size_t{1} << 20);
  const auto first = counted.get(7);
  EXPECT_EQ(counted.get(7), first);
  EXPECT_EQ(counted.reads, 1);
  EXPECT_EQ(first->tile_id, 7);
  EXPECT_NE(counted.get(7, 1), first) << "another level";
  EXPECT_EQ(counted.reads, 2);
  EXPECT_GE(counted.cache.bytes(), 2U * 100 * (32 + sizeof(Feature)));
}

TEST(TileCache, LetsTheLeastLatelyUsedGo) {
  Counted counted(3 * bytes_of_one());
  for (const std::int64_t id : {0, 1, 2}) counted.get(id);
  EXPECT_TRUE(counted.held(0));
  counted.get(3);
  EXPECT_FALSE(counted.held(1)) << "used before the others";
  EXPECT_TRUE(counted.held(0));
  EXPECT_FALSE(counted.held(2)) << "went for 1";
  EXPECT_LE(counted.cache.bytes(), 3 * bytes_of_one());
}

TEST(TileCache, NeverHoldsMoreThanItsBound) {
  Counted counted(10 * bytes_of_one() + 1);
  for (std::int64_t id = 0; id < 1000; ++id) {
    counted.get(id * id % 37);
    ASSERT_LE(counted.cache.bytes(), 10 * bytes_of_one() + 1);
  }
  const auto kept = counted.get(5);
  for (std::int64_t id = 100; id < 200; ++id) counted.get(id);
  EXPECT_EQ(kept->features.size(), 100U) << "what was handed out outlives the cache's interest";
}

TEST(TileCache, WithoutRoomReadsEachTime) {
  for (const std::size_t max_bytes : {std::size_t{0}, bytes_of_one() - 1}) {
    Counted counted(max_bytes);
    EXPECT_FALSE(counted.held(1));
    EXPECT_FALSE(counted.held(1));
    EXPECT_EQ(counted.get(1)->features.size(), 100U);
    EXPECT_EQ(counted.cache.bytes(), 0U);
  }
}

TEST(TileCache, RemembersThatThereIsNothing) {
  TileCache cache(1 << 20);
  int reads = 0;
  const auto nothing = [&]() -> std::optional<DecodedChip> {
    ++reads;
    return std::nullopt;
  };
  EXPECT_EQ(cache.get<DecodedChip>(1, 0, nothing), nullptr);
  EXPECT_EQ(cache.get<DecodedChip>(1, 0, nothing), nullptr);
  EXPECT_EQ(reads, 1);
  const auto row = [] { return std::optional(row_of(1, 3)); };
  EXPECT_EQ(cache.get<TileDescriptors>(1, 0, row)->features.size(), 3U) << "chips and descriptors of one tile are two";
}

TEST(TileCache, KeepsNothingOfAnError) {
  TileCache cache(1 << 20);
  const auto damaged = []() -> std::optional<TileDescriptors> { throw DataError("damaged"); };
  EXPECT_THROW(cache.get<TileDescriptors>(1, 0, damaged), DataError);
  EXPECT_THROW(cache.get<TileDescriptors>(1, 0, damaged), DataError);
  EXPECT_EQ(cache.bytes(), 0U);
}

TEST(TileCache, IsTheReadersOwn) {
  const testing::TemporaryFolder folder;
  const testing::SmallMap map = testing::make_small_map();
  testing::write_map(folder / "map.gpkg", map);
  MapReader reader = MapReader::open_unverified(folder / "map.gpkg");
  MapReader other = MapReader::open_unverified(folder / "map.gpkg");
  MapReader without = MapReader::open_unverified(folder / "map.gpkg", 0);
  const std::int64_t id = map.descriptors.front().tile_id;
  const int level = map.descriptors.front().level;
  const auto row = reader.descriptors(id, level);
  EXPECT_EQ(reader.descriptors(id, level), row);
  EXPECT_NE(other.descriptors(id, level), row);
  const auto again = without.descriptors(id, level);
  EXPECT_NE(without.descriptors(id, level), again);
  EXPECT_EQ(again->features.descriptors, row->features.descriptors);
  ASSERT_TRUE(reader.chip(map.chips.front().tile_id, map.chips.front().level));
}

}  // namespace
}  // namespace pilotage
