#include <algorithm>
#include <cmath>
#include <set>

#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <GeographicLib/PolarStereographic.hpp>
#include <GeographicLib/TransverseMercator.hpp>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/geo/enu_from_grid.h"
#include "pilotage/mapdb/map_reader.h"

namespace pilotage {
namespace {

double distance_in_grid_m(const Bounds& b, const Eigen::Vector2d& p) {
  const double dx = std::max({b.min_x_m - p.x(), 0.0, p.x() - b.max_x_m});
  const double dy = std::max({b.min_y_m - p.y(), 0.0, p.y() - b.max_y_m});
  return std::hypot(dx, dy);
}

std::set<std::int64_t> ids_of(const std::vector<NearTile>& tiles) {
  std::set<std::int64_t> ids;
  for (const NearTile& near : tiles) ids.insert(near.tile.tile_id);
  return ids;
}

class TilesNear : public ::testing::Test {
 protected:
  TilesNear() {
    testing::SmallMapOptions options;
    options.columns = 12;
    options.rows = 9;
    options.features_per_tile = 0;
    map_ = testing::make_small_map(options);
    testing::write_map(folder_ / "map.gpkg", map_);
  }
  testing::TemporaryFolder folder_;
  testing::SmallMap map_;
};

TEST_F(TilesNear, GridPointAgreesWithBruteForce) {
  MapReader reader = MapReader::open_unverified(folder_ / "map.gpkg");
  Random random(seed_from_name("TilesNear.GridPointAgreesWithBruteForce"));
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector2d p(random.uniform(379900, 380900), random.uniform(6439900, 6440700));
    const double radius_m = random.uniform(0, 150);
    std::set<std::int64_t> want;
    for (const MapTile& tile : map_.tiles) {
      if (tile.level == 1 && distance_in_grid_m(tile.bounds, p) <= radius_m) want.insert(tile.tile_id);
    }
    const auto got = reader.tiles_near(p, radius_m, 1);
    EXPECT_EQ(ids_of(got), want);
    EXPECT_TRUE(std::is_sorted(got.begin(), got.end(),
                               [](const NearTile& a, const NearTile& b) { return a.distance_m < b.distance_m; }));
  }
}

// The oracle projects the point with GeographicLib and measures in the grid, corrected by the scale there.
TEST_F(TilesNear, GeodeticPointAgreesWithProjection) {
  MapReader reader = MapReader::open_unverified(folder_ / "map.gpkg");
  Random random(seed_from_name("TilesNear.GeodeticPointAgreesWithProjection"));
  int found = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector2d p(random.uniform(379900, 380900), random.uniform(6439900, 6440700));
    double lat = 0, lon = 0, convergence = 0, scale = 0;
    GeographicLib::TransverseMercator::UTM().Reverse(117, p.x() - 500000, p.y() - 10000000, lat, lon, convergence,
                                                     scale);
    const double radius_m = random.uniform(0, 200);
    std::set<std::int64_t> surely;
    std::set<std::int64_t> perhaps;
    const auto got = reader.tiles_near(GeodeticPoint{lon, lat}, radius_m);
    for (const MapTile& tile : map_.tiles) {
      const double distance_m = distance_in_grid_m(tile.bounds, p) / scale;
      if (distance_m <= radius_m - 0.001) surely.insert(tile.tile_id);
      if (distance_m <= radius_m + 0.001) perhaps.insert(tile.tile_id);
      for (const NearTile& near : got) {
        if (near.tile.tile_id == tile.tile_id) {
          EXPECT_NEAR(near.distance_m, distance_m, 0.001);
        }
      }
    }
    const std::set<std::int64_t> ids = ids_of(got);
    EXPECT_TRUE(std::includes(ids.begin(), ids.end(), surely.begin(), surely.end()));
    EXPECT_TRUE(std::includes(perhaps.begin(), perhaps.end(), ids.begin(), ids.end()));
    found += static_cast<int>(ids.size());
  }
  EXPECT_GT(found, 1000);
}

TEST_F(TilesNear, NearestComesFirstAndIsTheOneAroundThePoint) {
  MapReader reader = MapReader::open_unverified(folder_ / "map.gpkg");
  for (const MapTile& tile : map_.tiles) {
    const auto got = reader.tiles_near(tile.center, 50, tile.level);
    ASSERT_FALSE(got.empty());
    EXPECT_EQ(got.front().tile.tile_id, tile.tile_id);
    EXPECT_EQ(got.front().distance_m, 0);
  }
}

TEST_F(TilesNear, RefusesWhatIsNotAPlace) {
  MapReader reader = MapReader::open_unverified(folder_ / "map.gpkg");
  EXPECT_THROW(reader.tiles_near(GeodeticPoint{0, 91}, 10), UsageError);
  EXPECT_THROW(reader.tiles_near(GeodeticPoint{std::nan(""), 0}, 10), UsageError);
  EXPECT_THROW(reader.tiles_near(GeodeticPoint{0, 0}, -1), UsageError);
  EXPECT_THROW(reader.tiles_near(GeodeticPoint{0, 0}, 1e6), UsageError);
  EXPECT_THROW(reader.tiles_near(Eigen::Vector2d(std::nan(""), 0), 10), UsageError);
  EXPECT_THROW(reader.tiles_near(Eigen::Vector2d(0, 0), std::nan("")), UsageError);
  EXPECT_TRUE(reader.tiles_near(GeodeticPoint{0, 0}, 100000).empty());
  EXPECT_EQ(reader.tiles_near(Eigen::Vector2d(0, 0), 1e9).size(), map_.tiles.size());
}

using Inverse = std::function<GeodeticPoint(const Eigen::Vector2d&)>;

/// Writes square tiles of 100 m around the grid's origin and checks every centre, and points between, against
/// geodesics.
void check_around_origin(const Inverse& geodetic_from_map, int half_count) {
  const testing::TemporaryFolder folder;
  testing::SmallMap map = testing::make_small_map();
  map.header.levels.resize(1);
  map.header.chips = false;
  map.tiles.clear();
  const auto inverse = [&](const Eigen::Vector2d& p) { return std::optional(geodetic_from_map(p)); };
  for (int row = -half_count; row < half_count; ++row) {
    for (int column = -half_count; column < half_count; ++column) {
      MapTile tile;
      tile.tile_id = static_cast<std::int64_t>(map.tiles.size());
      tile.bounds = {column * 100.0, row * 100.0, column * 100.0 + 100, row * 100.0 + 100};
      tile.center = geodetic_from_map(tile.bounds.center_m());
      tile.enu_from_grid = enu_from_grid(tile.bounds.center_m(), 100, inverse);
      map.tiles.push_back(tile);
    }
  }
  map.values.assign(map.tiles.size(), {1.0, 1.0, std::int64_t{0}, std::string("scored")});
  map.descriptors.clear();
  map.chips.clear();
  testing::write_map(folder / "map.gpkg", map);
  MapReader reader = MapReader::open_unverified(folder / "map.gpkg");
  Random random(seed_from_name("TilesNear.check_around_origin"));
  for (int trial = 0; trial < 200; ++trial) {
    const Eigen::Vector2d p(random.uniform(-60 * half_count, 60 * half_count),
                            random.uniform(-60 * half_count, 60 * half_count));
    const double radius_m = random.uniform(0, 300);
    GeodeticPoint point = geodetic_from_map(p);
    if (trial % 2 == 0) point.lon_deg += 360;  // longitudes mean the same modulo 360
    std::set<std::int64_t> surely;
    std::set<std::int64_t> perhaps;
    for (const MapTile& tile : map.tiles) {
      const double distance_m = distance_in_grid_m(tile.bounds, p);
      if (distance_m <= radius_m * 0.99 - 0.1) surely.insert(tile.tile_id);
      if (distance_m <= radius_m * 1.01 + 0.1) perhaps.insert(tile.tile_id);
    }
    const std::set<std::int64_t> ids = ids_of(reader.tiles_near(point, radius_m));
    ASSERT_TRUE(std::includes(ids.begin(), ids.end(), surely.begin(), surely.end())) << trial;
    ASSERT_TRUE(std::includes(perhaps.begin(), perhaps.end(), ids.begin(), ids.end())) << trial;
  }
}

TEST(TilesNearEdgesOfTheWorld, NorthPole) {
  check_around_origin(
      [](const Eigen::Vector2d& p) {
        double lat = 0, lon = 0;
        GeographicLib::PolarStereographic::UPS().Reverse(true, p.x(), p.y(), lat, lon);
        return GeodeticPoint{wrap_lon_deg(lon), lat};
      },
      6);
}

TEST(TilesNearEdgesOfTheWorld, SouthPole) {
  check_around_origin(
      [](const Eigen::Vector2d& p) {
        double lat = 0, lon = 0;
        GeographicLib::PolarStereographic::UPS().Reverse(false, p.x(), p.y(), lat, lon);
        return GeodeticPoint{wrap_lon_deg(lon), lat};
      },
      6);
}

TEST(TilesNearEdgesOfTheWorld, Antimeridian) {
  for (const double northing_m : {0.0, 7900000.0, -9000000.0}) {  // equator, 71° north, 81° south
    check_around_origin(
        [northing_m](const Eigen::Vector2d& p) {
          double lat = 0, lon = 0;
          GeographicLib::TransverseMercator::UTM().Reverse(180, p.x(), p.y() + northing_m, lat, lon);
          return GeodeticPoint{wrap_lon_deg(lon), lat};
        },
        6);
  }
}

}  // namespace
}  // namespace pilotage
