#include "pilotage/survey/plan_survey.h"

#include <cmath>

#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/ground/ground_of_rasters.h"

namespace pilotage {
namespace {

SurveyOptions over_flat_ground(double agl_m) {
  SurveyOptions options;
  options.camera.hfov_deg = 60;
  options.camera.width_px = 640;
  options.camera.height_px = 480;
  options.agl_m = agl_m;
  return options;
}

testing::RasterSpec area_of(int width_px, int height_px, double pixel_m = 1) {
  testing::RasterSpec spec;
  spec.width = width_px;
  spec.height = height_px;
  spec.place = GeoTransform::north_up(500000, 5'000'000, pixel_m);
  return spec;
}

template <class Error>
std::string refusal(const std::vector<std::string>& imagery, const SurveyOptions& options) {
  try {
    plan_survey(imagery, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "was not refused";
}

TEST(PlanSurvey, CutsTheWholeAreaIntoTilesOfTheFootprint) {
  const testing::TemporaryFolder folder;
  const std::string ortho = testing::make_raster(folder / "ortho.tif", area_of(600, 400));
  SurveyedGround area = plan_survey({ortho}, over_flat_ground(80));
  // 2 · 80 m · tan 30° wide, three quarters of that high.
  const double width_m = 160 * std::tan(M_PI / 6);
  EXPECT_NEAR(area.footprint_width_m, width_m, 1e-6);
  EXPECT_NEAR(area.footprint_height_m, width_m * 0.75, 1e-6);
  const GridLevel& level = area.ground.levels.front();
  EXPECT_NEAR(level.matrix.tile_size_px * level.gsd_m, width_m * std::sqrt(0.75), level.gsd_m);
  EXPECT_EQ(level.matrix.stride_px, (level.matrix.tile_size_px + 1) / 2);
  EXPECT_NEAR(level.gsd_m, 1, 0.001);  // the imagery's, on the ground
  EXPECT_EQ(level.search_radius_px, 50);
  EXPECT_TRUE(area.search_radius_assumed);
  EXPECT_EQ(level.min_agl_m, 80);
  cut_all_tiles(area.ground, 1);
  Bounds covered;
  for (const GroundTile& tile : area.ground.tiles) {
    covered.extend({tile.bounds.min_x_m, tile.bounds.min_y_m});
    covered.extend({tile.bounds.max_x_m, tile.bounds.max_y_m});
  }
  const double stride_m = level.matrix.stride_px * level.gsd_m;
  EXPECT_NEAR(covered.min_x_m, 500000, 1.1);
  EXPECT_NEAR(covered.max_y_m, 5'000'000, 1.1);
  EXPECT_GT(covered.max_x_m, 500600 - stride_m);
  EXPECT_LT(covered.min_y_m, 5'000'000 - 400 + stride_m);
}

// Metres of EPSG:3857 are 1.4 times too long there: areas and tiles are cut in a CRS whose metres are metres.
TEST(PlanSurvey, TilesOfWebMercatorImageryAreMetresOnTheGround) {
  const testing::TemporaryFolder folder;
  testing::RasterSpec spec = area_of(600, 400);
  spec.srs = "EPSG:3857";
  spec.place = GeoTransform::north_up(1'669'792, 5'621'521, 1);
  const SurveyedGround area = plan_survey({testing::make_raster(folder / "web.tif", spec)}, over_flat_ground(80));
  EXPECT_TRUE(area.ground.crs.is_projected());
  EXPECT_LT(area.ground.max_scale_distortion, 0.001);
  EXPECT_NEAR(area.ground.levels.front().gsd_m, 0.71, 0.02);
}

TEST(PlanSurvey, SaysWhatItNeeds) {
  const testing::TemporaryFolder folder;
  const std::string ortho = testing::make_raster(folder / "ortho.tif", area_of(600, 400));
  SurveyOptions options = over_flat_ground(80);
  EXPECT_THAT(refusal<UsageError>({}, options), ::testing::HasSubstr("imagery is missing"));
  options.agl_m.reset();
  EXPECT_THAT(refusal<UsageError>({ortho}, options), ::testing::StartsWith("agl_m is missing; give --agl-m"));
  options.camera = {};
  EXPECT_THAT(refusal<UsageError>({ortho}, options), ::testing::StartsWith("no camera: give --camera FILE"));
}

TEST(PlanSurvey, RefusesAFootprintLargerThanTheArea) {
  const testing::TemporaryFolder folder;
  const std::string ortho = testing::make_raster(folder / "ortho.tif", area_of(600, 400));
  const std::string said = refusal<DataError>({ortho}, over_flat_ground(500));
  EXPECT_THAT(said, ::testing::StartsWith("the camera's footprint from 500 m, as a square 500 m wide, is larger than "
                                          "the imagery of 600 m x 401 m"));
  EXPECT_EQ(refusal<DataError>({ortho}, over_flat_ground(390)), "was not refused");
}

TEST(PlanSurvey, RefusesMoreTilesThanAPageHolds) {
  const testing::TemporaryFolder folder;
  SurveyOptions options = over_flat_ground(20);
  options.tile_overlap = 0.95;
  const std::string ortho = testing::make_raster(folder / "ortho.tif", area_of(600, 400));
  EXPECT_THAT(
      refusal<DataError>({ortho}, options),
      ::testing::ContainsRegex("the area of 600 m x 401 m holds [0-9]+ tiles, one every 1.0 m; at most 100000"));
}

TEST(PlanSurvey, TellsImageryAndHeightsApart) {
  const testing::TemporaryFolder folder;
  const std::string ortho = testing::make_raster(folder / "ortho.tif", area_of(600, 400));
  testing::RasterSpec heights = area_of(600, 400);
  heights.type = GDT_Float32;
  const std::string dem = testing::make_raster(folder / "dem.tif", heights);
  testing::RasterSpec picture = area_of(600, 400);
  picture.bands = 3;
  const std::string colors = testing::make_raster(folder / "colors.tif", picture);
  SurveyOptions options = over_flat_ground(80);
  EXPECT_THAT(refusal<DataError>({dem}, options), ::testing::HasSubstr("Float32 values looks like an elevation model"));
  options.imagery_options.bands = {1};
  EXPECT_EQ(refusal<DataError>({dem}, options), "was not refused");  // who names the band knows it
  options = over_flat_ground(80);
  options.elevation = colors;
  EXPECT_THAT(refusal<DataError>({ortho}, options), ::testing::HasSubstr("looks like imagery"));
  options.elevation = ortho;
  EXPECT_THAT(refusal<UsageError>({ortho}, options), ::testing::HasSubstr("is the imagery, too"));
  options.elevation = dem;
  EXPECT_EQ(plan_survey({ortho}, options).ground.elevation, dem);
}

}  // namespace
}  // namespace pilotage
