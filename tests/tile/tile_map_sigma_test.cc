#include "pilotage/tile/tile_map_sigma.h"

#include <cmath>
#include <limits>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include "tile/small_mission.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/raster/map_sigma.h"
#include "pilotage/tile/plan_tiles.h"

namespace pilotage {
namespace {

using testing::change_raster;
using testing::error_of;
using ::testing::HasSubstr;
using testing::make_raster;
using testing::make_small_mission;
using testing::RasterSpec;
using testing::TemporaryFolder;
using testing::two_legs;

/// The small mission over imagery that names a raster of its own error: 3 m in the west of 500,300 m, 5 m in the east.
struct CapturedMission {
  CapturedMission() : options(make_small_mission(folder.path(), two_legs())) { name_map_sigma("ortho.map_sigma.tif"); }

  void name_map_sigma(const char* name) const {
    change_raster(folder / "ortho.tif", [&](GDALDataset& dataset) { dataset.SetMetadataItem(kMapSigmaTag, name); });
  }
  void write_map_sigma(double west_m, double east_m) const {
    RasterSpec spec;
    spec.width = 38;
    spec.height = 25;
    spec.bands = 2;
    spec.type = GDT_Float32;
    spec.place = GeoTransform::north_up(500'000, 5'000'000, 16);
    spec.value = [&](int band, int col, int) { return band == 1 ? 1 + col : (col * 16 < 300 ? west_m : east_m); };
    make_raster(folder / "ortho.map_sigma.tif", spec);
  }

  TemporaryFolder folder;
  TileOptions options;
};

TEST(MeasureMapSigma, TilesAndFlightHaveWhatTheImagerySaysOfItself) {
  const CapturedMission captured;
  captured.write_map_sigma(3, 5);
  const Mission mission = plan_tiles(captured.options);
  int west = 0;
  int east = 0;
  for (const GroundTile& tile : mission.ground.tiles) {
    ASSERT_TRUE(tile.map_sigma_m);
    if (tile.bounds.max_x_m < 500'260) {
      EXPECT_NEAR(*tile.map_sigma_m, 3, 1e-6);
      ++west;
    } else if (tile.bounds.min_x_m > 500'340) {
      EXPECT_NEAR(*tile.map_sigma_m, 5, 1e-6);
      ++east;
    } else {
      EXPECT_GE(*tile.map_sigma_m, 3 - 1e-6);
      EXPECT_LE(*tile.map_sigma_m, 5 + 1e-6);
    }
  }
  EXPECT_GT(west, 0);
  EXPECT_GT(east, 0);
  EXPECT_NEAR(*mission.flight.conditions.map_sigma_m, 5, 1e-6);
  EXPECT_EQ(*mission.flight.conditions.map_correlation_m, kCommonMapCorrelation_m);
  EXPECT_THAT(mission.notes,
              ::testing::Contains(HasSubstr("Error of the map: 3.00 to 5.00 m each axis, tile by tile")));
  // The plan's file keeps it.
  const Mission again = plan_from_json(plan_to_json(mission), "plan.json");
  EXPECT_EQ(again.ground.tiles.front().map_sigma_m, mission.ground.tiles.front().map_sigma_m);
  EXPECT_EQ(again.ground.imagery.datasets.front().map_sigma, (captured.folder / "ortho.map_sigma.tif").string());
}

TEST(MeasureMapSigma, ImageryThatSaysNothingCountsWhereItIsOnTop) {
  CapturedMission captured;
  captured.write_map_sigma(3, 5);
  RasterSpec spec;  // over the west, as far as 500,300 m
  spec.width = 300;
  spec.height = 400;
  spec.place = GeoTransform::north_up(500'000, 5'000'000, 1);
  captured.options.imagery.push_back(make_raster(captured.folder / "top.tif", spec));
  const Mission mission = plan_tiles(captured.options);
  for (const GroundTile& tile : mission.ground.tiles) {
    if (tile.bounds.max_x_m < 500'290) {
      EXPECT_EQ(tile.map_sigma_m, kUnknownMapSigma_m);
    } else if (tile.bounds.min_x_m > 500'340) {
      EXPECT_NEAR(*tile.map_sigma_m, 5, 1e-6);
    }
  }
  EXPECT_THAT(mission.notes, ::testing::Contains(HasSubstr(", 1 m of imagery that says nothing")));
  // Wholly covered, the one below says nothing of what is seen.
  spec.width = 600;
  make_raster(captured.folder / "top.tif", spec);
  const Mission covered = plan_tiles(captured.options);
  EXPECT_FALSE(covered.ground.tiles.front().map_sigma_m);
  EXPECT_EQ(*covered.flight.conditions.map_correlation_m, kMapCorrelation_m);
}

TEST(MeasureMapSigma, WhatThePlannerSaysCountsInstead) {
  CapturedMission captured;  // the raster is not even there
  captured.options.conditions.map_sigma_m = 2;
  const Mission mission = plan_tiles(captured.options);
  EXPECT_EQ(mission.ground.tiles.front().map_sigma_m, 2) << "the onboard map says it, too";
  EXPECT_EQ(mission.ground.imagery.datasets.front().map_sigma, "");
  EXPECT_EQ(*mission.flight.conditions.map_sigma_m, 2);
  EXPECT_EQ(*mission.flight.conditions.map_correlation_m, kMapCorrelation_m);
  EXPECT_THAT(mission.notes, ::testing::Contains(HasSubstr("2 m each axis as given")));
}

TEST(MeasureMapSigma, WhatIsNotThereOrNoErrorIsRefused) {
  const CapturedMission captured;
  const auto refused = [&] { return error_of<DataError>([&] { plan_tiles(captured.options); }); };
  EXPECT_THAT(refused(), HasSubstr("ortho.map_sigma.tif, which does not exist"));
  captured.write_map_sigma(3, -1);
  EXPECT_THAT(refused(), HasSubstr("-1 m is no standard deviation"));
  captured.write_map_sigma(3, 500);
  EXPECT_EQ(*plan_tiles(captured.options).flight.conditions.map_sigma_m, 100);
}

TEST(MapSigmaPath, StandsBesideTheImagery) {
  EXPECT_EQ(map_sigma_path("a/reference.tif"), "a/reference.map_sigma.tif");
  EXPECT_EQ(map_sigma_path("reference.TIFF"), "reference.map_sigma.tif");
  EXPECT_EQ(map_sigma_path("map.v1"), "map.v1.map_sigma.tif");
}

}  // namespace
}  // namespace pilotage
