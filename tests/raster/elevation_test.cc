#include "pilotage/raster/elevation.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::make_raster;
using testing::RasterSpec;
using testing::TemporaryFolder;

RasterSpec heights(GDALDataType type) {
  RasterSpec spec;
  spec.width = 600;
  spec.height = 400;
  spec.type = type;
  spec.place = GeoTransform::north_up(500000, 5'000'000, 10);
  spec.value = [](int, int col, int row) { return (col * 37 + row * 11) % 500 - 20; };
  return spec;
}

/// Ground at 60 m with a void of `value` in its middle third: 2 of 24 columns of 6 are declared no data.
RasterSpec with_void(double value, GDALDataType type = GDT_Float32) {
  RasterSpec spec;
  spec.width = spec.height = 24;
  spec.type = type;
  spec.place = GeoTransform::north_up(500000, 5'000'000, 10);
  spec.value = [value](int, int col, int) { return col >= 10 && col < 14 ? value : 60; };
  return spec;
}

GeodeticPoint utm_point(double x_m, double y_m) {
  return *CrsTransform(Crs::from_user_input("EPSG:32633")).geodetic_from_map({x_m, y_m});
}

TEST(Elevation, AValueThatNoGroundHasIsNoHeight) {
  const TemporaryFolder folder;
  for (const double value :
       {-32768.0, -32767.0, 32767.0, -9999.0, -999.0, -3.4028234663852886e38, 3.4028234663852886e38}) {
    const Elevation elevation(make_raster(folder / "dem.tif", with_void(value)));
    EXPECT_TRUE(std::isnan(elevation.amsl_m(utm_point(500125, 4'999'900)))) << value;
    EXPECT_NEAR(elevation.amsl_m(utm_point(500030, 4'999'900)), 60, 1e-9);
    const auto voids = elevation.undeclared_voids({});
    ASSERT_EQ(voids.size(), 1U) << value;
    EXPECT_TRUE(voids[0].certain);
    EXPECT_EQ(voids[0].pixels, 96);
    EXPECT_EQ(voids[0].looked_at, 576);
    EXPECT_THAT(undeclared_void_text("dem.tif", voids[0]),
                ::testing::AllOf(HasSubstr("96 of 576 heights (16.7 %)"), HasSubstr("gdal_translate -a_nodata ")));
    std::filesystem::remove(folder / "dem.tif");
  }
}

TEST(Elevation, AValueThatMayBeNoHeightIsTakenForGroundAndSaid) {
  const TemporaryFolder folder;
  for (const double value : {0.0, -99.0}) {
    const Elevation elevation(make_raster(folder / "dem.tif", with_void(value, GDT_Int16)));
    EXPECT_NEAR(elevation.amsl_m(utm_point(500125, 4'999'900)), value, 1e-9);
    const auto voids = elevation.undeclared_voids({});
    ASSERT_EQ(voids.size(), 1U) << value;
    EXPECT_FALSE(voids[0].certain);
    EXPECT_EQ(voids[0].stored, value);
    std::filesystem::remove(folder / "dem.tif");
  }
}

TEST(Elevation, TheSeaItsFloorAndDeclaredVoidsAreNoUndeclaredOnes) {
  const TemporaryFolder folder;
  // A beach that rises by 2 m a pixel from the sea's 0, and a sea's floor.
  RasterSpec coast = with_void(0);
  coast.value = [](int, int col, int) { return std::max(0, 2 * (col - 12)); };
  EXPECT_TRUE(Elevation(make_raster(folder / "coast.tif", coast)).undeclared_voids({}).empty());
  RasterSpec floor_of_sea = with_void(0);
  floor_of_sea.value = [](int, int col, int) { return -4000 - 100 * col; };
  const Elevation sea(make_raster(folder / "sea.tif", floor_of_sea));
  EXPECT_TRUE(sea.undeclared_voids({}).empty());
  EXPECT_LT(sea.amsl_m(utm_point(500125, 4'999'900)), -4000);
  RasterSpec declared = with_void(-9999);
  declared.finish = [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(-9999); };
  EXPECT_TRUE(Elevation(make_raster(folder / "declared.tif", declared)).undeclared_voids({}).empty());
}

TEST(Elevation, OfALargeModelTheBlocksAroundTheRouteAreLookedThrough) {
  const TemporaryFolder folder;
  RasterSpec spec = with_void(0);
  spec.width = spec.height = 9 * 256;
  spec.value = [](int, int col, int) { return col < 256 ? -32768 : 60; };
  const Elevation elevation(make_raster(folder / "dem.tif", spec));
  const std::vector<GeodeticPoint> west{utm_point(500010, 4'999'990)};
  const std::vector<GeodeticPoint> east{utm_point(520000, 4'999'990), utm_point(515000, 4'998'000)};
  EXPECT_EQ(elevation.undeclared_voids(west).size(), 1U);
  EXPECT_TRUE(elevation.undeclared_voids(east).empty());
  EXPECT_TRUE(elevation.undeclared_voids({}).empty()) << "around nothing";
}

TEST(Elevation, AnAssumedDatumSaysWhatTheOtherWouldGive) {
  const TemporaryFolder folder;
  const Elevation elevation(make_raster(folder / "dem.tif", with_void(60)));
  EXPECT_TRUE(elevation.datum_assumed());
  // EGM96 lies some 46 m above the ellipsoid at 45.15° N 15° E.
  EXPECT_THAT(elevation.vertical_datum(),
              ::testing::MatchesRegex("assumed to be metres above mean sea level .above the "
                                      "ellipsoid the ground would lie 4[4-7].. m lower."));
}

TEST(Elevation, IsBilinearBetweenPixelCentres) {
  const TemporaryFolder folder;
  const RasterSpec spec = heights(GDT_Int16);
  const Elevation elevation(make_raster(folder / "dem.tif", spec));
  const CrsTransform utm(Crs::from_user_input("EPSG:32633"));
  Random random(seed_from_name("Elevation"));
  for (int trial = 0; trial < 500; ++trial) {
    const double x = random.uniform(0.5, 599.4);  // pixel centres, so that the four neighbours exist
    const double y = random.uniform(0.5, 399.4);
    const auto point = utm.geodetic_from_map(spec.place.map_from_pixel({x, y}));
    const int col = static_cast<int>(std::floor(x - 0.5));
    const int row = static_cast<int>(std::floor(y - 0.5));
    const double fx = x - 0.5 - col;
    const double fy = y - 0.5 - row;
    const auto at = [&](int c, int r) { return spec.value(0, c, r); };
    const double expected = (1 - fy) * ((1 - fx) * at(col, row) + fx * at(col + 1, row)) +
                            fy * ((1 - fx) * at(col, row + 1) + fx * at(col + 1, row + 1));
    ASSERT_NEAR(elevation.amsl_m(*point), expected, 1e-4);
  }
  EXPECT_THAT(elevation.vertical_datum(), HasSubstr("assumed to be metres above mean sea level"));
  EXPECT_NEAR(elevation.resolution_m(), 10, 0.01);
}

TEST(Elevation, SaysNothingOutsideAndWhereThereIsNoData) {
  const TemporaryFolder folder;
  RasterSpec spec = heights(GDT_Float32);
  spec.value = [](int, int col, int row) { return col == 100 && row == 100 ? -9999 : 7; };
  spec.finish = [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(-9999); };
  const Elevation elevation(make_raster(folder / "dem.tif", spec));
  const CrsTransform utm(Crs::from_user_input("EPSG:32633"));
  const auto at = [&](double col, double row) {
    return elevation.amsl_m(*utm.geodetic_from_map(spec.place.map_from_pixel({col, row})));
  };
  EXPECT_EQ(at(0.1, 0.1), 7);  // within the outer half pixel
  EXPECT_EQ(at(599.9, 399.9), 7);
  EXPECT_TRUE(std::isnan(at(-0.1, 5)));
  EXPECT_TRUE(std::isnan(at(5, 400.1)));
  EXPECT_TRUE(std::isnan(at(100.2, 100.7)));
  EXPECT_TRUE(std::isnan(at(101.2, 100.7)));
  EXPECT_EQ(at(102.2, 100.7), 7);
  EXPECT_TRUE(std::isnan(elevation.amsl_m({-120, -45})));
  EXPECT_TRUE(std::isnan(elevation.amsl_m({NAN, 45})));
}

TEST(Elevation, KnowsUnitScaleAndOffset) {
  const TemporaryFolder folder;
  RasterSpec spec = heights(GDT_Int16);
  spec.value = [](int, int, int) { return 1000; };
  spec.finish = [](GDALDataset& dataset) {
    dataset.GetRasterBand(1)->SetUnitType("ft");
    dataset.GetRasterBand(1)->SetScale(0.5);
    dataset.GetRasterBand(1)->SetOffset(-100);
  };
  const Elevation elevation(make_raster(folder / "dem.tif", spec));
  EXPECT_NEAR(elevation.amsl_m({15.005, 45.14}), 400 * 0.3048, 1e-9);
  EXPECT_THAT(elevation.vertical_datum(), HasSubstr("in ft"));
}

TEST(Elevation, KnowsEverySpellingOfAUnit) {
  const TemporaryFolder folder;
  const auto metres_of_seven = [&](const char* unit) {
    RasterSpec spec = heights(GDT_Float32);
    spec.value = [](int, int, int) { return 7; };
    spec.finish = [unit](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetUnitType(unit); };
    const Elevation elevation(make_raster(folder / "dem.tif", spec));
    const CrsTransform utm(Crs::from_user_input("EPSG:32633"));
    return elevation.amsl_m(*utm.geodetic_from_map(spec.place.map_from_pixel({300, 200})));
  };
  for (const char* unit : {"", "m", "M", "Metre", "meters"}) EXPECT_NEAR(metres_of_seven(unit), 7, 1e-9) << unit;
  for (const char* unit : {"ft", "FT", "Feet", "FEET", "Foot", "foot (International)", "international_foot"}) {
    EXPECT_NEAR(metres_of_seven(unit), 7 * 0.3048, 1e-9) << unit;
  }
  for (const char* unit :
       {"us-ft", "US survey foot", "US_survey_foot", "Foot_US", "ftUS", "foot (U.S. survey)", "U.S. Feet"}) {
    EXPECT_NEAR(metres_of_seven(unit), 7 * 1200.0 / 3937.0, 1e-9) << unit;
  }
  EXPECT_NEAR(metres_of_seven("Clarke's foot"), 7 * 0.3047972654, 1e-9);
  EXPECT_NEAR(metres_of_seven("decimetre"), 0.7, 1e-9);
  EXPECT_NEAR(metres_of_seven("CM"), 0.07, 1e-9);
  EXPECT_NEAR(metres_of_seven("mm"), 0.007, 1e-9);
  EXPECT_NEAR(metres_of_seven("Kilometres"), 7000, 1e-9);
  for (const char* unit : {"furlong", "degree", "gal", "mft"}) {
    EXPECT_THAT([&] { metres_of_seven(unit); },
                ::testing::ThrowsMessage<DataError>(
                    HasSubstr("its heights are in \"" + std::string(unit) + "\", a unit that is not known")));
  }
}

TEST(Elevation, TakesTheGeoidOffEllipsoidalHeights) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.type = GDT_Float32;
  spec.srs = "EPSG:4979";
  spec.place = GeoTransform::north_up(-0.3, 0.2, 0.01);
  spec.value = [](int, int, int) { return 100; };
  const Elevation elevation(make_raster(folder / "dem.tif", spec));
  EXPECT_NEAR(elevation.amsl_m({0, 0}), 100 - 17.16, 0.05);  // EGM96 at 0° N, 0° E
  EXPECT_THAT(elevation.vertical_datum(), HasSubstr("transformed"));
}

TEST(Elevation, LeavesHeightsOfEgm96Alone) {
  const TemporaryFolder folder;
  RasterSpec spec = heights(GDT_Float32);
  spec.srs = "EPSG:32633+5773";
  spec.value = [](int, int, int) { return 123; };
  EXPECT_NEAR(Elevation(make_raster(folder / "dem.tif", spec)).amsl_m({15.005, 45.14}), 123, 1e-6);
}

TEST(Elevation, ReachesAcrossTheAntimeridian) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.type = GDT_Int16;
  spec.srs = "EPSG:4326";
  spec.place = GeoTransform::north_up(179.7, -16.8, 0.01);
  spec.value = [](int, int col, int) { return col; };
  const Elevation elevation(make_raster(folder / "dem.tif", spec));
  EXPECT_NEAR(elevation.amsl_m({179.8, -17}), 9.5, 1e-6);
  EXPECT_NEAR(elevation.amsl_m({-179.9, -17}), 39.5, 1e-6);
}

TEST(Elevation, BadInputIsNamed) {
  const TemporaryFolder folder;
  EXPECT_THROW(Elevation("missing.tif"), DataError);
  RasterSpec spec = heights(GDT_Int16);
  spec.srs = "";
  const std::string bare = make_raster(folder / "bare.tif", spec);
  EXPECT_THROW(Elevation{bare}, DataError);
  EXPECT_NO_THROW(Elevation(bare, "EPSG:32633"));
}

}  // namespace
}  // namespace pilotage
