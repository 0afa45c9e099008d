#include "pilotage/tile/plan_tiles.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include "tile/small_mission.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/mission/tile_under.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::make_small_mission;
using testing::MissionPoint;
using testing::TemporaryFolder;
using ::testing::ThrowsMessage;
using testing::two_legs;

std::string plan_error(const TileOptions& options) {
  return testing::error_of<std::exception>([&] { plan_tiles(options); });
}

void expect_sound(const Mission& mission) {
  for (const FlightSample& sample : mission.flight.samples) {
    if (sample.level != FlightSample::kNoLevel) {
      EXPECT_TRUE(tile_under(mission, sample)) << sample.distance_m;
    }
  }
  std::int64_t before = -1;
  for (const GroundTile& tile : mission.ground.tiles) {
    const TileMatrix& matrix = mission.ground.levels.at(static_cast<std::size_t>(tile.level)).matrix;
    EXPECT_GT(tile.tile_id, before);
    before = tile.tile_id;
    EXPECT_EQ(tile.tile_id, tile_id_of(mission.ground.levels, tile.level, tile.column, tile.row));
    EXPECT_NEAR(tile.bounds.max_x_m - tile.bounds.min_x_m, matrix.tile_size_px * matrix.map_from_pixel.x_per_col, 1e-6);
  }
}

TEST(PlanTiles, OneHeightIsOneLevelOfTilesOfTheFootprint) {
  const TemporaryFolder folder;
  const Mission mission = plan_tiles(make_small_mission(folder.path(), two_legs()));
  ASSERT_EQ(mission.ground.levels.size(), 1u);
  // 2 · 80 m · tan 30° wide, 3/4 of that high.
  const double width_m = 160 * std::tan(std::acos(-1.0) / 6);
  EXPECT_NEAR(mission.flight.footprint_width_m, width_m, 1e-6);
  EXPECT_NEAR(mission.flight.footprint_height_m, width_m * 0.75, 1e-6);
  EXPECT_NEAR(mission.ground.levels[0].matrix.tile_size_px * mission.ground.levels[0].gsd_m, width_m * std::sqrt(0.75),
              0.51);
  EXPECT_THAT(mission.ground.crs.name(), HasSubstr("UTM zone 33N"));
  EXPECT_EQ(mission.flight.route.legs.size(), 2u);
  expect_sound(mission);
  for (const GroundTile& tile : mission.ground.tiles) EXPECT_EQ(tile.valid_fraction, 1) << tile.tile_id;
}

TEST(PlanTiles, HeightsOfMoreThanAFactorOfTwoMakeLevels) {
  const TemporaryFolder folder;
  const Mission mission =
      plan_tiles(make_small_mission(folder.path(), {MissionPoint{150, 150, 50}, {450, 150, 160}, {450, 260, 160}}));
  ASSERT_EQ(mission.ground.levels.size(), 2u);
  EXPECT_GT(mission.ground.levels[1].matrix.tile_size_px * mission.ground.levels[1].gsd_m,
            mission.ground.levels[0].matrix.tile_size_px * mission.ground.levels[0].gsd_m);
  expect_sound(mission);
  for (const FlightSample& sample : mission.flight.samples) {
    const GridLevel& level = mission.ground.levels.at(static_cast<std::size_t>(sample.level));
    EXPECT_GE(sample.agl_m, level.min_agl_m * (1 - 1e-9));
    EXPECT_LE(sample.agl_m, level.max_agl_m * (1 + 1e-9));
  }
}

TEST(PlanTiles, RefusesMoreTilesThanAGroundMayHaveBeforeItCutsThem) {
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), two_legs());
  options.corridor_half_width_m = 50000;
  options.tile_size_px = 16;
  EXPECT_THAT(plan_error(options), AllOf(HasSubstr("the corridor, 100000 m wide"), HasSubstr("one every"),
                                         HasSubstr("at most 10000000 are planned; look at corridor_half_width_m")));
}

TEST(PlanTiles, NarrowCorridorHasTheTileUnderEveryPoint) {
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), {MissionPoint{103, 107, 80}, {497, 291, 80}});
  options.corridor_half_width_m = 1;
  expect_sound(plan_tiles(options));
}

TEST(PlanTiles, PartsBelowTheLowestHeightHaveNoLevel) {
  const TemporaryFolder folder;
  const Mission mission =
      plan_tiles(make_small_mission(folder.path(), {MissionPoint{100, 150, 20}, {300, 150, 60}, {500, 150, 60}}));
  EXPECT_EQ(mission.flight.samples.front().level, FlightSample::kNoLevel);
  EXPECT_EQ(mission.flight.samples.back().level, 0);
  EXPECT_THAT(mission.warnings, ::testing::Contains(HasSubstr("are flown lower than 30 m above the ground")));
}

/// Heights of route.geojson become heights above home.
TileOptions over_home(const TemporaryFolder& folder, double home_amsl_m) {
  TileOptions options = make_small_mission(folder.path(), two_legs());
  options.elevation = testing::make_flat_elevation(folder.path(), 50);
  options.route_options.height_reference = HeightReference::kAuto;
  options.route = (folder.path() / "route.plan").string();
  const CrsTransform transform(Crs::from_user_input("EPSG:32633"));
  std::string items;
  for (const MissionPoint& point : two_legs()) {
    const GeodeticPoint at = transform.geodetic_from_map({500'000 + point.east_m, 5'000'000 - point.south_m}).value();
    items += std::string(items.empty() ? "" : ",") +
             R"({"type":"SimpleItem","command":16,"frame":3,"autoContinue":true,"params":[0,0,0,null,)" +
             format_number(at.lat_deg) + "," + format_number(at.lon_deg) + "," + format_number(point.agl_m) + "]}";
  }
  write_file(options.route,
             R"({"fileType":"Plan","version":1,"groundStation":"QGroundControl","mission":{"version":2,)"
             R"("plannedHomePosition":[45.153,15.001,)" +
                 format_number(home_amsl_m) + R"(],"items":[)" + items + "]}}",
             true);
  options.tile_size_px = 90;
  options.gsd_m = 1;
  return options;
}

TEST(PlanTiles, SaysHowGoodHeightsAre) {
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), two_legs());
  EXPECT_EQ(plan_tiles(options).ground.elevation_sigma_m, std::nullopt);
  options.elevation_sigma_m = 2;
  EXPECT_THAT([&] { plan_tiles(options); },
              ThrowsMessage<UsageError>(HasSubstr("elevation_sigma_m is of an elevation")));
  options.elevation = testing::make_flat_elevation(folder.path(), 50);
  EXPECT_EQ(plan_tiles(options).ground.elevation_sigma_m, 2);
  options.elevation_sigma_m.reset();
  EXPECT_EQ(plan_tiles(options).ground.elevation_sigma_m, 4) << "a height every 10 m";
  options.elevation = testing::make_flat_elevation(folder.path(), 50, 2);
  EXPECT_EQ(plan_tiles(options).ground.elevation_sigma_m, 1) << "every 2 m";
}

TEST(PlanTiles, WarnsOfAHomeThatIsNotOnItsGround) {  // 2026-11: home 400 m off its ground passed in silence
  const TemporaryFolder folder;
  const auto of_home = ::testing::Contains(HasSubstr("Home is said"));
  EXPECT_THAT(plan_tiles(over_home(folder, 50.8)).warnings, ::testing::Not(of_home));
  const Mission mission = plan_tiles(over_home(folder, 450.8));
  EXPECT_NEAR(mission.flight.samples.front().agl_m, 480.8, 0.1);
  EXPECT_THAT(mission.warnings, ::testing::Contains(HasSubstr("Home is said to lie at 450.8 m above sea level, but the "
                                                              "elevation model has 50.0 m there")));
}

TEST(PlanTiles, WarnsOfLowLegsUnlessToldToFlyThere) {
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), {MissionPoint{100, 150, 60}, {300, 150, 60}, {500, 150, 15}});
  EXPECT_THAT(plan_tiles(options).warnings, ::testing::Contains(HasSubstr("Only 15.0 m above the ground at lat 45.")));
  options.min_agl_m = 10;
  EXPECT_THAT(plan_tiles(options).warnings, ::testing::Not(::testing::Contains(HasSubstr("above the ground"))));
}

TEST(PlanTiles, CrsIsObeyedOrRefused) {
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), two_legs());
  options.crs = "EPSG:3035";  // Lambert azimuthal equal area of Europe: 0.06 % here
  EXPECT_THAT(plan_tiles(options).ground.crs.name(), HasSubstr("LAEA"));
  options.crs = "EPSG:3857";
  EXPECT_THROW(plan_tiles(options), UsageError);
  options.crs = "EPSG:4326";
  EXPECT_THAT(plan_error(options), HasSubstr("is not projected"));
}

TEST(PlanTiles, MissionsWithOneGridOriginShareTheirTiles) {
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), two_legs());
  options.crs = "EPSG:32633";
  const GridLevel free = plan_tiles(options).ground.levels.front();
  const double stride_m = free.matrix.stride_px * free.gsd_m;
  options.grid_origin_m = {free.matrix.map_from_pixel.origin_x + 0.25 * stride_m - 7 * stride_m,
                           free.matrix.map_from_pixel.origin_y - 0.5 * stride_m + 3 * stride_m};
  const Mission mission = plan_tiles(options);
  expect_sound(mission);
  const TileMatrix& matrix = mission.ground.levels.front().matrix;
  const double columns = (matrix.map_from_pixel.origin_x - options.grid_origin_m[0]) / stride_m;
  const double rows = (matrix.map_from_pixel.origin_y - options.grid_origin_m[1]) / stride_m;
  EXPECT_NEAR(columns, std::round(columns), 1e-6);
  EXPECT_NEAR(rows, std::round(rows), 1e-6);
  options.grid_origin_m = {1, 2, 3};
  EXPECT_THAT(plan_error(options), HasSubstr("has 3 numbers"));
  options.grid_origin_m = {1e300, 2};
  EXPECT_THAT(plan_error(options), HasSubstr("grid_origin_m = 1e+300 is outside"));
  options.grid_origin_m = {1, 2};
  options.crs.clear();
  EXPECT_THAT(plan_error(options), HasSubstr("give --crs"));
}

TEST(PlanTiles, NamesThePartOutsideTheImagery) {
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), {MissionPoint{100, 150, 80}, {900, 150, 80}});
  EXPECT_THAT(plan_error(options), ::testing::ContainsRegex("leaves the imagery from 0\\.5[01] km to 0\\.80 km .*up to "
                                                            "(299|300|301) m outside"));
  options.allow_uncovered = true;
  const Mission mission = plan_tiles(options);
  expect_sound(mission);
  EXPECT_THAT(mission.warnings, ::testing::Contains(HasSubstr("leaves the imagery")));
  EXPECT_EQ(mission.ground.tiles.front().valid_fraction, 1);
  bool none = false;
  for (const GroundTile& tile : mission.ground.tiles) none = none || tile.valid_fraction == 0;
  EXPECT_TRUE(none);
}

TEST(PlanTiles, NoDataUnderTheRouteIsRefusedAsOutside) {  // 2026-11: a route over a mask passed without a word
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), two_legs());
  testing::RasterSpec spec;
  spec.width = 600;
  spec.height = 400;
  spec.srs = "EPSG:32633";
  spec.place = GeoTransform::north_up(500'000, 5'000'000, 1);
  spec.value = [](int, int col, int row) { return col < 300 ? 0.0 : 20.0 + (col / 8 * 7 + row / 8 * 13) % 200; };
  options.imagery = {testing::make_raster(folder.path() / "half.tif", spec)};
  options.imagery_options.nodata = 0;
  EXPECT_THAT(plan_error(options),
              ::testing::ContainsRegex("the route lies where the imagery has no data from 0\\.00 km to 0\\.(19|20) km "
                                       ".*or give --allow-uncovered"));
  options.allow_uncovered = true;
  EXPECT_THAT(plan_tiles(options).warnings,
              ::testing::Contains(HasSubstr("where the imagery has no data from 0.00 km")));
  spec.value = [](int, int col, int row) {  // a hole smaller than a tile
    return col > 180 && col < 205 && row > 130 && row < 170 ? 0.0 : 20.0 + (col / 8 * 7 + row / 8 * 13) % 200;
  };
  options.imagery = {testing::make_raster(folder.path() / "hole.tif", spec)};
  options.allow_uncovered = false;
  EXPECT_EQ(plan_error(options), "");
}

TEST(PlanTiles, FlatGroundAtHomeWhereNoElevationIsGiven) {  // 2026-11: every plan of QGroundControl was refused
  const TemporaryFolder folder;
  TileOptions options = over_home(folder, 50.8);
  EXPECT_FALSE(plan_tiles(options).flight.flat_ground_amsl_m);
  options.elevation.clear();
  const Mission mission = plan_tiles(options);
  ASSERT_TRUE(mission.flight.flat_ground_amsl_m);
  EXPECT_EQ(*mission.flight.flat_ground_amsl_m, 50.8);
  for (const FlightSample& sample : mission.flight.samples) EXPECT_NEAR(sample.agl_m, 80, 1e-9);
  EXPECT_THAT(mission.warnings, ::testing::Contains(HasSubstr("the ground is assumed flat at home's height, 50.8 m")));
  options.route_options.home_amsl_m = 20;
  EXPECT_EQ(plan_tiles(options).flight.flat_ground_amsl_m, 20);
  options.route_options.home_amsl_m.reset();
  options.route_options.agl_m = 90;
  EXPECT_FALSE(plan_tiles(options).flight.flat_ground_amsl_m) << "heights above ground need no ground";
}

TEST(PlanTiles, NamesWhatIsHardlyMeant) {
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), two_legs());
  const auto warns = [&](const std::string& text) {
    return ::testing::Value(plan_tiles(options).warnings, ::testing::Contains(HasSubstr(text)));
  };
  EXPECT_TRUE(warns("no inertial grade is given (--ins-grade): tactical is assumed"));
  EXPECT_FALSE(plan_tiles(options).flight.ins.grade);
  options.ins.grade = InsGrade::kTactical;
  EXPECT_FALSE(warns("inertial grade"));
  EXPECT_FALSE(warns("elevation model, not like imagery"));
  options = make_small_mission(folder.path(), two_legs());
  options.imagery = {testing::make_flat_elevation(folder.path(), 50)};
  EXPECT_TRUE(warns("elevation.tif: its one band of Float32 values looks like an elevation model"));
}

TEST(PlanTiles, AsksWhetherLatitudeAndLongitudeAreExchanged) {
  const TemporaryFolder folder;
  const TileOptions options = make_small_mission(folder.path(), two_legs());
  const GeodeticPoint at = plan_tiles(options).flight.route.vertices.front().point;
  write_file(options.route,
             R"({"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[[)" +
                 format_number(at.lat_deg) + "," + format_number(at.lon_deg) + ",80],[" + format_number(at.lat_deg) +
                 "," + format_number(at.lon_deg + 0.004) + ",80]]}}",
             true);
  EXPECT_THAT(plan_error(options), HasSubstr("with latitude and longitude exchanged it begins inside the imagery"));
}

TEST(PlanTiles, CoverageCountsThePixelsThatScoreReads) {  // 2026-11: 30 % of random holes passed for a coverage of 1
  const TemporaryFolder folder;
  const TileOptions options = make_small_mission(folder.path(), two_legs());
  testing::change_raster(options.imagery[0], [](GDALDataset& dataset) {
    Random random(seed_from_name("holes"));
    GDALRasterBand& band = *dataset.GetRasterBand(1);
    ASSERT_EQ(band.SetNoDataValue(0), CE_None);
    std::vector<std::uint8_t> grays(600 * 400);
    ASSERT_EQ(band.RasterIO(GF_Read, 0, 0, 600, 400, grays.data(), 600, 400, GDT_Byte, 0, 0, nullptr), CE_None);
    for (std::uint8_t& gray : grays) gray = random.uniform() < 0.3 ? 0 : gray;
    ASSERT_EQ(band.RasterIO(GF_Write, 0, 0, 600, 400, grays.data(), 600, 400, GDT_Byte, 0, 0, nullptr), CE_None);
    const int half = 2;  // averages over what is valid: no hole is left
    ASSERT_EQ(dataset.BuildOverviews("AVERAGE", 1, &half, 0, nullptr, nullptr, nullptr), CE_None);
  });
  const Mission mission = plan_tiles(options);
  for (const GroundTile& tile : mission.ground.tiles) {
    const GridLevel& level = mission.ground.levels.at(static_cast<std::size_t>(tile.level));
    const double scored =
        valid_fraction(open_gray(mission.ground, level), level.matrix.tile_window(tile.column, tile.row));
    EXPECT_EQ(tile.valid_fraction, scored) << tile.tile_id;
    EXPECT_NEAR(tile.valid_fraction, 0.7, 0.03) << tile.tile_id;
  }
}

TEST(PlanTiles, RefusesTilesLargerThanTheImagery) {
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), two_legs());
  options.tile_size_px = 450;
  EXPECT_THAT(plan_error(options), HasSubstr("larger than the imagery of 600 m x 400 m"));
}

TEST(PlanTiles, WorksAcrossTheAntimeridianAndNearThePole) {
  // UTM zone 1 begins at the antimeridian; in zone 60's own metres the same ground lies east of 834 km.
  for (const testing::SmallPlace& place : {testing::SmallPlace{"EPSG:32660", 833'700, 100'000},
                                           testing::SmallPlace{"EPSG:32661", 2'000'000 - 300, 2'100'000}}) {
    const TemporaryFolder folder;
    const Mission mission = plan_tiles(make_small_mission(folder.path(), two_legs(), place));
    expect_sound(mission);
    double east_deg = -180;
    double west_deg = 180;
    for (const FlightSample& sample : mission.flight.samples) {
      east_deg = std::max(east_deg, sample.point.lon_deg);
      west_deg = std::min(west_deg, sample.point.lon_deg);
    }
    if (place.srs == "EPSG:32660") {
      EXPECT_GT(east_deg - west_deg, 359);
    }
    EXPECT_LT(mission.ground.tiles.size(), 60u);
    for (const GroundTile& tile : mission.ground.tiles) EXPECT_GT(tile.valid_fraction, 0.99) << tile.tile_id;
  }
}

TEST(PlanTiles, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  TileOptions options = make_small_mission(folder.path(), two_legs());
  options.imagery.clear();
  EXPECT_THAT(plan_error(options), HasSubstr("imagery is missing"));
  options = make_small_mission(folder.path(), two_legs());
  options.route_options.speed_mps.reset();
  EXPECT_THAT(plan_error(options), HasSubstr("give --speed-mps"));
}

}  // namespace
}  // namespace pilotage
