#include "pilotage/mission/tile_under.h"

#include <cmath>

#include "select/straight_mission.h"
#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

TEST(TileIdOf, CountsLevelByLevelRowByRow) {
  std::vector<GridLevel> levels(2);
  for (GridLevel& level : levels) {
    level.matrix.tile_size_px = 10;
    level.matrix.stride_px = 10;
    level.matrix.grid_width_px = 70;
    level.matrix.grid_height_px = 30;
  }
  std::int64_t expected = 0;
  for (int level = 0; level < 2; ++level) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 7; ++column) EXPECT_EQ(tile_id_of(levels, level, column, row), expected++);
    }
  }
}

// Against a search through all tiles of the matrix.
TEST(TileUnder, FindsTheTileWithTheNearestCentre) {
  const Mission mission = testing::straight_mission(2000, 60);
  Random random(seed_from_name("TileLookup"));
  int found = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    FlightSample sample;
    sample.level = 0;
    sample.point_map_m = {random.uniform(-100, 2100), random.uniform(-120, 120)};
    const auto index = tile_under(mission, sample);
    double nearest = 1e9;
    std::size_t nearest_index = 0;
    for (std::size_t i = 0; i < mission.ground.tiles.size(); ++i) {
      const double distance =
          (mission.ground.tiles[i].bounds.center_m() - sample.point_map_m).lpNorm<Eigen::Infinity>();
      if (distance < nearest) {
        nearest = distance;
        nearest_index = i;
      }
    }
    ASSERT_EQ(index.has_value(), nearest <= 25) << sample.point_map_m.transpose();
    if (!index) continue;
    ++found;
    EXPECT_EQ(*index, nearest_index);
  }
  EXPECT_GT(found, 500);
}

TEST(TileUnder, NothingWithoutALevelOrOutsideTheMatrix) {
  const Mission mission = testing::straight_mission(500);
  FlightSample sample = mission.flight.samples.front();
  EXPECT_TRUE(tile_under(mission, sample));
  sample.level = FlightSample::kNoLevel;
  EXPECT_FALSE(tile_under(mission, sample));
  sample.level = 0;
  sample.point_map_m = {1e9, -1e9};
  EXPECT_FALSE(tile_under(mission, sample));
}

}  // namespace
}  // namespace pilotage
