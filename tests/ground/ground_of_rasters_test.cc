#include "pilotage/ground/ground_of_rasters.h"

#include <cmath>

#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::make_raster;
using testing::RasterSpec;
using testing::TemporaryFolder;
using ::testing::ThrowsMessage;

RasterGridOptions small_tiles() {
  RasterGridOptions options;
  options.tile_size_px = 16;
  options.stride_px = 8;
  options.search_radius_px = 4;
  return options;
}

TEST(GroundOfRasters, IsTheRastersOwnGrid) {
  const TemporaryFolder folder;
  const std::string file = make_raster(folder / "a.tif", {});  // 60 x 40 px of 0.5 m
  Ground ground = ground_of_rasters({file}, small_tiles()).ground;
  EXPECT_TRUE(ground.imagery.own_grid);
  ASSERT_EQ(ground.imagery.datasets.size(), 1U);
  EXPECT_EQ(ground.imagery.datasets[0].dataset, file);
  EXPECT_EQ(ground.imagery.datasets[0].width_px, 60);
  ASSERT_EQ(ground.levels.size(), 1U);
  const TileMatrix& matrix = ground.levels[0].matrix;
  EXPECT_EQ(matrix.grid_width_px, 60);
  EXPECT_EQ(matrix.grid_height_px, 40);
  EXPECT_EQ(matrix.tile_size_px, 16);
  EXPECT_EQ(matrix.stride_px, 8);
  EXPECT_EQ(ground.levels[0].search_radius_px, 4);
  EXPECT_NEAR(ground.levels[0].gsd_m, 0.5 / 0.9996, 1e-6) << "on the ground, at the central meridian";
  EXPECT_TRUE(std::isnan(ground.levels[0].min_agl_m)) << "nobody flies";
  EXPECT_TRUE(ground.tiles.empty());

  cut_all_tiles(ground);
  ASSERT_EQ(ground.tiles.size(), 6U * 4U);
  const GroundTile& tile = ground.tiles[7];  // column 1 of row 1
  EXPECT_EQ(tile.tile_id, 7);
  EXPECT_EQ(tile.cell(), (TileCell{1, 1}));
  EXPECT_EQ(tile.bounds.min_x_m, 500004);
  EXPECT_EQ(tile.bounds.max_x_m, 500012);
  EXPECT_EQ(tile.bounds.max_y_m, 4999996);
  EXPECT_EQ(tile.bounds.min_y_m, 4999988);
  EXPECT_NEAR(tile.center.lon_deg, 15, 2e-4) << "central meridian of zone 33";
  EXPECT_TRUE(std::isnan(tile.valid_fraction)) << "not known before it is scored";

  const std::vector<std::int64_t> some{3, 7, 20};
  cut_tiles(ground, some);
  ASSERT_EQ(ground.tiles.size(), 3U);
  EXPECT_EQ(ground.tiles[1].tile_id, 7);
  EXPECT_EQ(ground.tiles[1].bounds.min_x_m, 500004);
  EXPECT_EQ(ground.tiles[2].cell(), (TileCell{2, 3}));
}

TEST(GroundOfRasters, WithoutOptionsTilesHaveTheSizesThatTheHelpNames) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.width = spec.height = 320;
  const Ground ground = ground_of_rasters({make_raster(folder / "a.tif", spec)}, {}).ground;
  EXPECT_EQ(ground.levels[0].matrix.tile_size_px, 256);
  EXPECT_EQ(ground.levels[0].matrix.stride_px, 64);
  EXPECT_EQ(ground.levels[0].search_radius_px, 128);
}

TEST(GroundOfRasters, SeveralRastersAreResampledToACommonGrid) {
  const TemporaryFolder folder;
  const std::string west = make_raster(folder / "west.tif", {});
  RasterSpec spec;
  spec.place = GeoTransform::north_up(500030.5, 5'000'000, 0.5);
  const std::string east = make_raster(folder / "east.tif", spec);
  RasterGridOptions options = small_tiles();
  EXPECT_THAT(
      [&] {
        ground_of_rasters({west, east}, options);
      },
      ThrowsMessage<UsageError>(HasSubstr("several rasters need a common grid; give --gsd-m")));
  options.gsd_m = 1;
  const Ground ground = ground_of_rasters({west, east}, options).ground;
  EXPECT_FALSE(ground.imagery.own_grid);
  EXPECT_EQ(ground.imagery.datasets.size(), 2U);
  const TileMatrix& matrix = ground.levels[0].matrix;
  EXPECT_EQ(ground.levels[0].gsd_m, 1);
  EXPECT_EQ(matrix.map_from_pixel.origin_x, 500000);
  EXPECT_EQ(matrix.map_from_pixel.origin_y, 5000000);
  EXPECT_EQ(matrix.grid_width_px, 61) << "60.5 m, rounded up";
  EXPECT_EQ(matrix.grid_height_px, 20);
}

TEST(GroundOfRasters, ACrsNeedsAGroundSampleDistance) {
  const TemporaryFolder folder;
  const std::string file = make_raster(folder / "a.tif", {});
  RasterGridOptions options = small_tiles();
  options.crs = "EPSG:32632";
  EXPECT_THAT([&] { ground_of_rasters({file}, options); }, ThrowsMessage<UsageError>(HasSubstr("--crs needs --gsd-m")));
  EXPECT_THAT([&] { ground_of_rasters({}, options); },
              ThrowsMessage<UsageError>(HasSubstr("there is no raster to score")));
}

TEST(GroundOfRasters, RefusesTilesLargerThanTheImagery) {
  const TemporaryFolder folder;
  const std::string file = make_raster(folder / "a.tif", {});
  RasterGridOptions options = small_tiles();
  options.tile_size_px = 41;
  EXPECT_THAT([&] { ground_of_rasters({file}, options); },
              ThrowsMessage<DataError>(
                  HasSubstr("tile_size_px = 41: a tile of 41 x 41 px is larger than the imagery of 60 x 40 px")));
  options.tile_size_px = 40;
  EXPECT_EQ(ground_of_rasters({file}, options).ground.levels[0].matrix.tile_count(), 3);
}

TEST(CutTiles, RefusesMoreThanFitInMemoryBeforeTakingAny) {
  Ground ground;
  ground.crs = testing::utm33();
  ground.levels.push_back({});
  ground.levels[0].matrix = {0, GeoTransform::north_up(500000, 5'000'000, 0.5), 1'000'000, 1'000'000, 256, 64};
  EXPECT_THAT([&] { cut_all_tiles(ground); },
              ThrowsMessage<DataError>(HasSubstr("244046884 tiles (of 256 px, every 64 px of 1000000 x 1000000 px)")));
}

TEST(GroundOfRasters, InDegreesTilesHaveAPlaceButNoBoundsInMetres) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.srs = "EPSG:4326";
  spec.place = GeoTransform::north_up(15, 45, 1e-5);
  Ground ground = ground_of_rasters({make_raster(folder / "a.tif", spec)}, small_tiles()).ground;
  cut_all_tiles(ground);
  const GroundTile& tile = ground.tiles.front();
  EXPECT_TRUE(std::isnan(tile.bounds.min_x_m) && std::isnan(tile.bounds.min_y_m));
  EXPECT_TRUE(std::isnan(tile.bounds.max_x_m) && std::isnan(tile.bounds.max_y_m));
  EXPECT_NEAR(tile.center.lon_deg, 15 + 8e-5, 1e-9);
  EXPECT_NEAR(tile.center.lat_deg, 45 - 8e-5, 1e-9);
}

TEST(GroundOfRasters, FeetAreConvertedToMetres) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.srs = "EPSG:2229";  // California zone 5, US survey feet
  spec.place = GeoTransform::north_up(6'500'000, 1'800'000, 2);
  Ground ground = ground_of_rasters({make_raster(folder / "a.tif", spec)}, small_tiles()).ground;
  cut_all_tiles(ground);
  constexpr double kFoot_m = 1200.0 / 3937;
  const GroundTile& tile = ground.tiles.front();
  EXPECT_NEAR(tile.bounds.min_x_m, 6'500'000 * kFoot_m, 1e-6);
  EXPECT_NEAR(tile.bounds.max_y_m, 1'800'000 * kFoot_m, 1e-6);
  EXPECT_NEAR(tile.bounds.width_m(), 16 * 2 * kFoot_m, 1e-6);
  EXPECT_NEAR(ground.levels[0].gsd_m, 2 * kFoot_m, 1e-3) << "true within the scale of the projection";
}

TEST(RefuseRasterGrid, NamesEachOptionThatIsGiven) {
  EXPECT_NO_THROW(refuse_raster_grid({}, "plan.json"));
  const auto refused = [](const std::string& name, auto give) {
    RasterGridOptions options;
    give(options);
    EXPECT_THAT([&] { refuse_raster_grid(options, "plan.json"); },
                ThrowsMessage<UsageError>(HasSubstr(name + " is for rasters; plan.json is a plan")));
  };
  refused("tile_size_px", [](auto& options) { options.tile_size_px = 256; });
  refused("stride_px", [](auto& options) { options.stride_px = 64; });
  refused("search_radius_px", [](auto& options) { options.search_radius_px = 128; });
  refused("bands", [](auto& options) { options.imagery.bands = {1}; });
  refused("imagery_crs", [](auto& options) { options.imagery.imagery_crs = "EPSG:4326"; });
  refused("nodata", [](auto& options) { options.imagery.nodata = 0; });
  refused("resampling", [](auto& options) { options.imagery.resampling = Resampling::kBilinear; });
  refused("gsd_m", [](auto& options) { options.gsd_m = 1; });
  refused("crs", [](auto& options) { options.crs = "EPSG:32633"; });
}

}  // namespace
}  // namespace pilotage
