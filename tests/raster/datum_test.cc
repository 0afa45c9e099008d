#include <algorithm>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/raster/gdal_datum.h"
#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::make_raster;
using testing::RasterSpec;
using testing::TemporaryFolder;

constexpr GeodeticPoint kKansas{-98.54, 39.22};
constexpr GeodeticPoint kAustria{15, 48.75};

TEST(DatumShift, AccuracyIsTheRegistrys) {
  // EPSG: NAD27 to WGS 84 (6), three parameters, 7 m; NAD27 to NAD83 (1) by the grid of NADCON, with NAD83 to WGS 84.
  const DatumShift shift = datum_shift(Crs::from_user_input("EPSG:26714"), kKansas);
  EXPECT_FALSE(shift.ballpark);
  if (!shift.missing_grid.empty()) {
    EXPECT_THAT(shift.operation, HasSubstr("NAD27 to WGS 84 (6)"));
    EXPECT_EQ(shift.accuracy_m, 7.0);
    EXPECT_EQ(shift.missing_grid, "us_noaa_conus.tif");
    EXPECT_LT(shift.accuracy_with_grid_m.value_or(99), 7);
  }
  EXPECT_FALSE(datum_shift(Crs::from_user_input("EPSG:32633"), kAustria).accuracy_m) << "no change of datum";
  EXPECT_EQ(datum_shift(Crs::from_user_input("EPSG:25833"), kAustria).accuracy_m, 1.0) << "ETRS89 to WGS 84 (1)";
  const DatumShift may76 = datum_shift(Crs::from_user_input("EPSG:2029"), {-81, 44});
  if (!may76.missing_grid.empty()) {
    EXPECT_TRUE(may76.ballpark);
    EXPECT_EQ(may76.missing_grid, "ca_nrc_MAY76V20.tif");
  }
}

TEST(DatumShift, ADatumThatIsNotNamedIsNone) {
  const auto ellipsoid = [](const std::string& crs) { return ellipsoid_without_datum(Crs::from_user_input(crs)); };
  EXPECT_EQ(ellipsoid("+proj=utm +zone=33 +ellps=bessel"), "Bessel 1841");
  EXPECT_THAT(ellipsoid("+proj=longlat +ellps=intl"), HasSubstr("International 1924"));
  EXPECT_EQ(ellipsoid("+proj=utm +zone=33 +ellps=WGS84"), "");
  EXPECT_EQ(ellipsoid("+proj=utm +zone=33 +ellps=GRS80"), "");
  EXPECT_EQ(ellipsoid("+proj=utm +zone=33 +ellps=bessel +towgs84=577,90,464,5,1,5,2.4"), "") << "says how to get there";
  EXPECT_EQ(ellipsoid("EPSG:31257"), "");
  EXPECT_EQ(near_wgs84(Crs::from_user_input("+proj=utm +zone=33 +ellps=WGS84")), NearWgs84::kSame);
  EXPECT_EQ(near_wgs84(Crs::from_user_input("EPSG:25833")), NearWgs84::kNear);
  EXPECT_EQ(near_wgs84(Crs::from_user_input("EPSG:31257")), NearWgs84::kFar);
}

TEST(DatumShift, DatumsOfAnEllipsoidAreThoseInUseThere) {
  const auto possible = possible_datums("Bessel 1841", kAustria);
  const auto mgi =
      std::find_if(possible.begin(), possible.end(), [](const auto& datum) { return datum.name == "MGI"; });
  ASSERT_NE(mgi, possible.end());
  EXPECT_NEAR(mgi->shift_m, 103, 3);  // by PROJ, MGI to WGS 84 (3)
  EXPECT_TRUE(std::none_of(possible.begin(), possible.end(), [](const auto& datum) { return datum.name == "Tokyo"; }));
}

RasterSpec of_crs(const std::string& srs, const GeoTransform& place) {
  RasterSpec spec;
  spec.srs = srs;
  spec.place = place;
  return spec;
}

std::string error_of_raster(const std::filesystem::path& path, const RasterSpec& spec,
                            const ImageryOptions& options = {}) {
  const std::string file = make_raster(path, spec);
  return testing::error_of<DataError>([&] { inspect_imagery(file, options); });
}

TEST(InspectImagery, CoordinatesOfAnEllipsoidAloneAreRefusedUntilSomeoneSaysTheDatum) {
  const TemporaryFolder folder;
  const RasterSpec spec =
      of_crs("+proj=utm +zone=33 +ellps=bessel +no_defs", GeoTransform::north_up(500000, 5'400'000, 0.5));
  EXPECT_THAT(error_of_raster(folder / "a.tif", spec),
              AllOf(HasSubstr("names no datum, only the ellipsoid \"Bessel 1841\""), HasSubstr("on MGI it lies 103 m"),
                    HasSubstr("--imagery-crs")));
  ImageryOptions options;
  options.imagery_crs = "+proj=utm +zone=33 +ellps=bessel +towgs84=577.326,90.129,463.919,5.137,1.474,5.297,2.4232";
  const ImageryInfo said = inspect_imagery((folder / "a.tif").string(), options);
  EXPECT_NEAR(said.center.lon_deg, 14.9990, 1e-3);
  EXPECT_THAT(said.warnings, ::testing::Contains(HasSubstr("taken is the one given")));
}

TEST(InspectImagery, AChangeOfDatumIsSaidWithItsAccuracy) {
  const TemporaryFolder folder;
  const ImageryInfo nad27 = inspect_imagery(
      make_raster(folder / "a.tif", of_crs("EPSG:26714", GeoTransform::north_up(540000, 4'340'000, 0.5))));
  if (nad27.datum_accuracy_m > 0) {
    EXPECT_EQ(nad27.datum_accuracy_m, 7);
    EXPECT_THAT(nad27.warnings, ::testing::Contains(AllOf(HasSubstr("within 7 m"), HasSubstr("us_noaa_conus.tif"))));
  }
  EXPECT_EQ(inspect_imagery(make_raster(folder / "b.tif", RasterSpec{})).datum_accuracy_m, 0);
  const std::string canada =
      error_of_raster(folder / "c.tif", of_crs("EPSG:2029", GeoTransform::north_up(500000, 4'870'000, 0.5)));
  if (!canada.empty()) {
    EXPECT_THAT(canada, AllOf(HasSubstr("changes no datum"), HasSubstr("ca_nrc_MAY76V20.tif")));
  }
}

TEST(InspectImagery, DegreesUnderMetresAreRefused) {
  const TemporaryFolder folder;
  for (const char* crs : {"EPSG:32633", "EPSG:3857", "EPSG:2154"}) {
    EXPECT_THAT(error_of_raster(folder / "a.tif", of_crs(crs, GeoTransform::north_up(15.0, 48.75, 1e-5))),
                AllOf(HasSubstr("look like degrees"), HasSubstr("lon 15.0003000, lat 48.7498000")))
        << crs;
    std::filesystem::remove(folder / "a.tif");
  }
  // Small pixels of metres, far from degrees: a model on a table.
  EXPECT_EQ(error_of_raster(folder / "b.tif", of_crs("EPSG:32633", GeoTransform::north_up(500000, 5'400'000, 5e-4))),
            "");
}

}  // namespace
}  // namespace pilotage
