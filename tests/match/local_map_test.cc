#include "pilotage/match/local_map.h"

#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

using testing::make_small_map;
using testing::SmallMap;
using testing::TemporaryFolder;

/// A small map on disk, its contents, and a reader.
struct OpenMap {
  explicit OpenMap(SmallMap contents) : map(std::move(contents)) {
    path = folder / "map.gpkg";
    testing::write_map(path, map);
    reader = MapReader::open_unverified(path);
  }

  LocalGrid grid(int level = 0) { return *local_grid(*reader, *reader->find_level(level), map.tiles[0].center, 1000); }

  TemporaryFolder folder;
  SmallMap map;
  std::filesystem::path path;
  std::optional<MapReader> reader;
};

SmallMap small_map(int features_per_tile = 60) {
  testing::SmallMapOptions options;
  options.features_per_tile = features_per_tile;
  return make_small_map(options);
}

TEST(LocalGridTest, PixelsAndPlacesThereAndBack) {
  OpenMap open(small_map());
  const LocalGrid grid = open.grid();
  for (const Eigen::Vector2d& px : {Eigen::Vector2d(0, 0), Eigen::Vector2d(-300.25, 700), Eigen::Vector2d(190, 127)}) {
    EXPECT_LT((grid.px_from_geodetic(grid.geodetic_from_px(px)) - px).norm(), 1e-5);
  }
}

TEST(LocalGridTest, AgreesWithTheProjectionAtEveryTile) {
  for (const bool north : {false, true}) {
    testing::SmallMapOptions options;
    options.columns = 9;
    options.rows = 8;
    options.northern_hemisphere = north;
    OpenMap open(make_small_map(options));
    for (const int level : {0, 1}) {
      const LocalGrid grid = open.grid(level);
      for (const MapTile& tile : open.map.tiles) {
        if (tile.level != level) continue;
        const Eigen::Vector2d middle_px((static_cast<double>(tile.column) + 0.5) * 64,
                                        (static_cast<double>(tile.row) + 0.5) * 64);
        EXPECT_LT((grid.px_from_geodetic(tile.center) - middle_px).norm() * grid.gsd_m(), 0.01);
      }
    }
  }
}

TEST(LocalGridTest, ConvergenceAndPixelSizeAreThoseOnTheGround) {
  for (const bool north : {false, true}) {
    testing::SmallMapOptions options;
    options.northern_hemisphere = north;
    OpenMap open(make_small_map(options));
    const LocalGrid grid = open.grid();
    const GeodeticPoint here = grid.geodetic_from_px({96, 64});
    const GeodesicLeg up = geodesic_between(here, grid.geodetic_from_px({96, -136}));
    const GeodesicLeg right = geodesic_between(here, grid.geodetic_from_px({296, 64}));
    EXPECT_NEAR(grid.convergence_deg(), up.start_azimuth_deg, 1e-3);
    EXPECT_NEAR(right.start_azimuth_deg, up.start_azimuth_deg + 90, 1e-3);
    EXPECT_NEAR(grid.gsd_m(), up.length_m / 200, 1e-5);
    EXPECT_NEAR(grid.gsd_m(), right.length_m / 200, 1e-5);
    // West of the central meridian grid north lies west of true north in the south, east of it in the north.
    EXPECT_GT(std::abs(grid.convergence_deg()), 0.3);
  }
}

TEST(LocalGridTest, WhereTheMapHasNoTileThereIsNone) {
  OpenMap open(small_map());
  const MapLevel& level = *open.reader->find_level(0);
  const GeodeticPoint away = geodesic_direct(open.map.tiles[0].center, 270, 500);
  EXPECT_FALSE(local_grid(*open.reader, level, away, 400));
  EXPECT_TRUE(local_grid(*open.reader, level, away, 600));
  EXPECT_THROW(local_grid(*open.reader, level, {16, 91}, 400), UsageError);
}

TEST(LocalGridTest, WhereThereIsNoTileItIsNorthUpWithTheLevelsPixels) {
  MapLevel level;
  level.gsd_m = 0.7;
  const GeodeticPoint about{115.9, -31.9};
  const LocalGrid grid = plain_grid(level, about);
  EXPECT_NEAR(grid.gsd_m(), 0.7, 1e-12);
  EXPECT_NEAR(grid.convergence_deg(), 0, 1e-12);
  EXPECT_NEAR(grid.px_from_geodetic(about).norm(), 0, 1e-6);
  const GeodeticPoint there = LocalFrame(about).geodetic_from_enu({70, 140, 0});
  const Eigen::Vector2d there_px = grid.px_from_geodetic(there);
  EXPECT_NEAR(there_px.x(), 100, 1e-3);
  EXPECT_NEAR(there_px.y(), -200, 1e-3);
  EXPECT_NEAR(grid.geodetic_from_px(there_px).lat_deg, there.lat_deg, 1e-9);
}

TEST(LevelForHeight, TheBandThatHoldsItElseTheNearest) {
  testing::SmallMapOptions options;
  options.levels = 3;
  SmallMap map = make_small_map(options);
  const double edges[] = {30, 60, 120, 240};
  for (std::size_t level = 0; level < 3; ++level) {
    map.header.levels[level].min_agl_m = edges[level];
    map.header.levels[level].max_agl_m = edges[level + 1];
  }
  OpenMap open(std::move(map));
  for (const auto& [height_m, level] : {std::pair(1.0, 0), std::pair(29.0, 0), std::pair(45.0, 0), std::pair(61.0, 1),
                                        std::pair(119.0, 1), std::pair(130.0, 2), std::pair(1e5, 2)}) {
    ASSERT_NE(level_for_height(*open.reader, height_m), nullptr);
    EXPECT_EQ(level_for_height(*open.reader, height_m)->matrix.level, level) << height_m;
  }
}

/// What tells features apart: tile and place, to 1/16 px.
using FeatureKey = std::tuple<std::int64_t, double, double>;

TEST(ReadLocalMap, HasTheFeaturesInsideTheSquareAndNoOthers) {
  OpenMap open(small_map());
  const LocalGrid grid = open.grid();
  for (const auto& [center_px, half_width_px] :
       {std::pair(Eigen::Vector2d(96, 64), 40.0), std::pair(Eigen::Vector2d(61.3, 66.8), 25.5),
        std::pair(Eigen::Vector2d(-10, 5), 30.0), std::pair(Eigen::Vector2d(96, 64), 500.0)}) {
    const LocalMap local = read_local_map(*open.reader, *open.reader->find_level(0), grid, center_px, half_width_px);
    std::multiset<FeatureKey> expected;
    for (const TileDescriptors& stored : open.map.descriptors) {
      if (stored.level != 0) continue;
      for (const Feature& feature : stored.features.features) {
        const Eigen::Vector2d place(static_cast<double>(stored.window.col) + static_cast<double>(feature.x_px),
                                    static_cast<double>(stored.window.row) + static_cast<double>(feature.y_px));
        if ((place - center_px).cwiseAbs().maxCoeff() > half_width_px) continue;
        expected.insert({stored.tile_id, place.x(), place.y()});
      }
    }
    std::multiset<FeatureKey> read;
    for (std::size_t i = 0; i < local.features.size(); ++i) {
      const Feature& feature = local.features.features[i];
      read.insert({local.tile_ids[i], static_cast<double>(feature.x_px) + local.reference_px.x(),
                   static_cast<double>(feature.y_px) + local.reference_px.y()});
    }
    EXPECT_FALSE(expected.empty());
    EXPECT_EQ(read, expected);
  }
}

TEST(ReadLocalMap, KeepsDescriptorsAndHeights) {
  OpenMap open(small_map(20));
  const LocalMap local = read_local_map(*open.reader, *open.reader->find_level(0), open.grid(), {96, 64}, 500);
  ASSERT_EQ(local.features.size(), 6U * 20);
  ASSERT_EQ(local.ground_height_m.size(), local.features.size());
  ASSERT_EQ(local.features.descriptors.size(),
            local.features.size() * static_cast<std::size_t>(local.features.descriptor_bytes));
  std::map<std::int64_t, std::size_t> next;
  for (std::size_t i = 0; i < local.features.size(); ++i) {
    const auto tile = static_cast<std::size_t>(local.tile_ids[i]);
    const std::size_t at = next[local.tile_ids[i]]++;
    const TileDescriptors& stored = open.map.descriptors[tile];
    EXPECT_TRUE(std::equal(stored.features.descriptor(at),
                           stored.features.descriptor(at) + stored.features.descriptor_bytes,
                           local.features.descriptor(i)));
    const float height_m =
        stored.ground_height_m.empty() ? std::numeric_limits<float>::quiet_NaN() : stored.ground_height_m[at];
    EXPECT_TRUE(local.ground_height_m[i] == height_m || (std::isnan(height_m) && std::isnan(local.ground_height_m[i])));
  }
}

TEST(ReadLocalMap, OutsideTheMapItIsEmpty) {
  OpenMap open(small_map());
  const LocalMap local = read_local_map(*open.reader, *open.reader->find_level(0), open.grid(), {-900, 64}, 100);
  EXPECT_EQ(local.features.size(), 0U);
  EXPECT_TRUE(local.tile_ids.empty());
}

TEST(ReadLocalMap, EndsWithTheTileThatMakesItTooMany) {
  OpenMap open(small_map(20));
  const MapLevel& level = *open.reader->find_level(0);
  const auto count = [&](std::size_t max_features) {
    return read_local_map(*open.reader, level, open.grid(), {96, 64}, 500, max_features).features.size();
  };
  EXPECT_EQ(count(6 * 20), 6U * 20);
  EXPECT_EQ(count(40), 60U);
  EXPECT_EQ(count(0), 20U);
}

TEST(ReadLocalMap, TilesOfSeveralDescriptorLengthsAreADataError) {
  SmallMap map = small_map(20);
  FeatureSet& features = map.descriptors[4].features;
  features.descriptor_bytes = 32;
  features.descriptors.resize(features.size() * 32);
  OpenMap open(std::move(map));
  const MapLevel& level = *open.reader->find_level(0);
  try {
    read_local_map(*open.reader, level, open.grid(), {96, 64}, 500);
    FAIL();
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("descriptors of "));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("16"));
  }
  // Tile 4 is the lower middle one; a square that does not come near it is not concerned.
  EXPECT_GT(read_local_map(*open.reader, level, open.grid(), {20, 20}, 15).features.size(), 0U);
}

}  // namespace
}  // namespace pilotage
