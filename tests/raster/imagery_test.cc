#include <cmath>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core/hal/interface.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::make_raster;
using testing::RasterSpec;
using testing::TemporaryFolder;

std::string imagery_error(const std::string& dataset, const ImageryOptions& options = {}) {
  return testing::error_of<std::runtime_error>([&] { inspect_imagery(dataset, options); });
}

TEST(Imagery, SaysWhatARasterIs) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 3;
  spec.creation_options = {"PHOTOMETRIC=RGB"};
  spec.finish = [](GDALDataset& dataset) { dataset.SetMetadataItem("TIFFTAG_DATETIME", "2019:08:17 10:11:12"); };
  const std::string path = make_raster(folder / "a.tif", spec);
  const ImageryInfo info = inspect_imagery(path);
  EXPECT_EQ(info.dataset, path);
  EXPECT_EQ(info.driver, "GTiff");
  EXPECT_EQ(info.width_px, 60);
  EXPECT_EQ(info.height_px, 40);
  EXPECT_EQ(info.map_from_pixel, spec.place);
  EXPECT_EQ(info.crs.authority(), "EPSG:32633");
  EXPECT_EQ(info.depth, CV_8U);
  EXPECT_EQ(info.band_type, "Byte");
  EXPECT_EQ(info.band_colors, (std::vector<std::string>{"Red", "Green", "Blue"}));
  EXPECT_EQ(info.mask, MaskKind::kNone);
  EXPECT_EQ(info.overviews, 0);
  EXPECT_EQ(info.acquired, "2019-08-17");
  EXPECT_NEAR(info.gsd_x_m, 0.5 / 0.9996, 1e-6);
  EXPECT_NEAR(info.gsd_y_m, 0.5 / 0.9996, 1e-6);
  EXPECT_NEAR(info.center.lon_deg, 15, 1e-3);
  EXPECT_THAT(info.warnings, IsEmpty());
}

TEST(Imagery, MeasuresGroundWhateverTheUnit) {
  const TemporaryFolder folder;
  RasterSpec feet;
  feet.srs = "EPSG:2994";  // Oregon Lambert in international feet
  feet.place = GeoTransform::north_up(635615, 853362, 1);
  EXPECT_NEAR(inspect_imagery(make_raster(folder / "feet.tif", feet)).gsd_x_m, 0.3048, 0.3048 * 3e-4);

  RasterSpec degrees;
  degrees.srs = "EPSG:4326";
  degrees.place = GeoTransform::north_up(-115.2, 60.0002, 1e-5);
  const ImageryInfo info = inspect_imagery(make_raster(folder / "degrees.tif", degrees));
  // Radii of curvature of WGS 84 at 60° N: M = 6,383,453.9 m; N cos φ = 3,197,104.6 m.
  EXPECT_NEAR(info.gsd_y_m, 6383453.9 * 1e-5 * M_PI / 180, 1e-6);
  EXPECT_NEAR(info.gsd_x_m, 3197104.6 * 1e-5 * M_PI / 180, 1e-6);
  EXPECT_THAT(info.warnings, Contains(HasSubstr("not square")));

  RasterSpec web;
  web.srs = "EPSG:3857";
  web.place = GeoTransform::north_up(0, 8399737.89, 0.5);  // 60° N on the sphere of EPSG:3857
  EXPECT_NEAR(inspect_imagery(make_raster(folder / "web.tif", web)).gsd_x_m, 0.25, 0.25 * 0.004);

  RasterSpec rotated;
  rotated.place = {500000, 0.4, 0.3, 5'000'000, 0.3, -0.4};
  const ImageryInfo turned = inspect_imagery(make_raster(folder / "rotated.tif", rotated));
  EXPECT_NEAR(turned.gsd_x_m, 0.5 / 0.9996, 1e-6);
  EXPECT_NEAR(turned.gsd_y_m, 0.5 / 0.9996, 1e-6);
}

TEST(Imagery, NeedsAGeoreferenceAndACrs) {
  const TemporaryFolder folder;
  EXPECT_THAT(imagery_error(make_raster(folder / "nowhere.tif", {.georeferenced = false})),
              HasSubstr("no georeference"));

  const std::string bare = make_raster(folder / "bare.tif", {.srs = ""});
  EXPECT_THAT(imagery_error(bare), HasSubstr("bare.tif: states no CRS; give --imagery-crs"));
  ImageryOptions options;
  options.imagery_crs = "EPSG:32633";
  EXPECT_EQ(inspect_imagery(bare, options).crs.authority(), "EPSG:32633");
  EXPECT_NO_THROW(open_gray(bare, options));
  options.imagery_crs = "EPSG:nothing";
  EXPECT_THAT(imagery_error(bare, options), HasSubstr("EPSG:nothing"));

  const std::string own = make_raster(folder / "own.tif", {});
  options.imagery_crs = "EPSG:32634";
  EXPECT_EQ(inspect_imagery(own, options).crs.authority(), "EPSG:32633");
  EXPECT_THAT(inspect_imagery(own, options).warnings, Contains(HasSubstr("is not used")));

  EXPECT_THAT(imagery_error(make_raster(folder / "local.tif", {.srs = "LOCAL_CS[\"site\",UNIT[\"metre\",1]]"})),
              HasSubstr("local.tif"));
  RasterSpec flat;
  flat.place = {500000, 0.5, 0.5, 5'000'000, 0.5, 0.5};
  EXPECT_THAT(imagery_error(make_raster(folder / "flat.tif", flat)), HasSubstr("cannot be inverted"));
  RasterSpec off;
  off.srs = "EPSG:4326";
  off.place = GeoTransform::north_up(500000, 5'000'000, 0.5);
  EXPECT_THAT(imagery_error(make_raster(folder / "off.tif", off)), HasSubstr("is its CRS right?"));
}

std::string make_with_points(const std::filesystem::path& path, bool affine) {
  RasterSpec spec;
  spec.georeferenced = false;
  spec.srs = "";
  spec.finish = [affine](GDALDataset& dataset) {
    std::array<GDAL_GCP, 4> points{};
    GDALInitGCPs(4, points.data());
    for (int i = 0; i < 4; ++i) {
      GDAL_GCP& point = points[static_cast<std::size_t>(i)];
      point.dfGCPPixel = i % 2 * 60;
      point.dfGCPLine = i / 2 * 40;
      point.dfGCPX = 500000 + 0.5 * point.dfGCPPixel + (i == 3 && !affine ? 5 : 0);
      point.dfGCPY = 5e6 - 0.5 * point.dfGCPLine;
    }
    OGRSpatialReference reference;
    reference.importFromEPSG(32633);
    dataset.SetGCPs(4, points.data(), &reference);
    GDALDeinitGCPs(4, points.data());
  };
  return make_raster(path, spec);
}

TEST(Imagery, GroundControlPointsOfOneTransformArePlacedByIt) {
  const TemporaryFolder folder;
  const std::string good = make_with_points(folder / "good.tif", true);
  const ImageryInfo info = inspect_imagery(good);
  EXPECT_NEAR(info.map_from_pixel.x_per_col, 0.5, 1e-9);
  EXPECT_NEAR(info.map_from_pixel.origin_y, 5e6, 1e-6);
  EXPECT_THAT(info.warnings, Contains(HasSubstr("ground control points")));
  EXPECT_EQ(open_gray(good).map_from_pixel, info.map_from_pixel);
  EXPECT_THAT(imagery_error(make_with_points(folder / "bent.tif", false)),
              HasSubstr("4 ground control points; left out of the fit, they miss their places by"));
}

TEST(Imagery, ReadsDatesInTheirManySpellings) {
  const TemporaryFolder folder;
  const auto date_of = [&](const char* name, const char* domain, const char* text) {
    RasterSpec spec;
    spec.finish = [&](GDALDataset& dataset) { dataset.SetMetadataItem(name, text, domain); };
    return inspect_imagery(make_raster(folder / "a.tif", spec)).acquired;
  };
  EXPECT_EQ(date_of("TIFFTAG_DATETIME", "", "2020:07:01 00:00:00"), "2020-07-01");
  EXPECT_EQ(date_of("ACQUISITIONDATETIME", "IMAGERY", "2010-04-01 12:00:00"), "2010-04-01T12:00:00Z");
  EXPECT_EQ(date_of("acquisition_start", "", "2018-11-30T10:00:00Z"), "2018-11-30T10:00:00Z");
  EXPECT_EQ(date_of("acquisition_start", "", "2018-11-30T10:00:00+02:00"), "2018-11-30");
  EXPECT_EQ(date_of("PRODUCT_START_TIME", "", "2021-06-12T10:30:21.024Z"), "2021-06-12T10:30:21Z");
  EXPECT_EQ(date_of("PRODUCT_START_TIME", "", "2021-06-12T00:00:00.000Z"), "2021-06-12") << "no hour is known";
  EXPECT_EQ(date_of("NITF_IDATIM", "", "20150228120000"), "2015-02-28T12:00:00Z");
  EXPECT_EQ(date_of("TIFFTAG_DATETIME", "", "0000:00:00 00:00:00"), "");
  EXPECT_EQ(date_of("TIFFTAG_DATETIME", "", "last week"), "");
  EXPECT_EQ(date_of("ACQUISITION_DATE", "", "2018-1-3"), "");
  EXPECT_EQ(date_of("nothing", "", "2018-01-03"), "");
}

// A date that cannot be read is not a date that is missing: libtiff leaves the tag out and goes on.
TEST(Imagery, ATagThatCannotBeReadIsAnError) {
  const testing::TemporaryFolder folder;
  RasterSpec spec;
  spec.finish = [](GDALDataset& dataset) { dataset.SetMetadataItem("TIFFTAG_DATETIME", "2019:08:17 10:11:12"); };
  const std::string path = make_raster(folder / "dated.tif", spec);
  EXPECT_EQ(inspect_imagery(path).acquired, "2019-08-17");
  std::string bytes = read_file(path);
  const std::string entry = {0x32, 0x01, 0x02, 0x00, 20, 0, 0, 0};  // tag 306, text of 20 bytes; then where it lies
  const std::size_t at = bytes.find(entry);
  ASSERT_NE(at, std::string::npos);
  bytes[at + entry.size() + 3] = 0x7F;  // beyond the file's end
  write_file(path, bytes, true);
  EXPECT_THAT(testing::error_of<DataError>([&] { inspect_imagery(path); }),
              AllOf(HasSubstr(path + ": cannot be read whole: "), HasSubstr("\"DateTime\"")));
}

TEST(Imagery, BoundsFollowCurvedEdges) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.srs = "EPSG:4326";
  spec.width = spec.height = 40;
  spec.place = GeoTransform::north_up(14, 61, 0.05);  // 2° × 2° around 15° E, 60° N
  const ImageryInfo info = inspect_imagery(make_raster(folder / "a.tif", spec));
  const Bounds bounds = imagery_bounds(info, Crs::from_user_input("EPSG:32633"));
  const CrsTransform transform(Crs::from_user_input("EPSG:32633"));
  // The southern edge reaches furthest south in its middle, not at its corners.
  EXPECT_NEAR(bounds.min_y_m, transform.map_from_geodetic({15, 59})->y(), 1);
  EXPECT_NEAR(bounds.max_x_m, transform.map_from_geodetic({16, 59})->x(), 1);
  EXPECT_NEAR(bounds.max_y_m, transform.map_from_geodetic({16, 61})->y(), 1);
  EXPECT_NEAR(imagery_bounds(info, info.crs).max_y_m, 61, 1e-12);
}

TEST(Imagery, WarnsOfPartsThatDoNotFitTogether) {
  const TemporaryFolder folder;
  const ImageryInfo a = inspect_imagery(make_raster(folder / "a.tif", {}));
  RasterSpec spec;
  spec.place = GeoTransform::north_up(500000, 5'000'000, 0.504);
  const ImageryInfo near = inspect_imagery(make_raster(folder / "near.tif", spec));
  spec.place = GeoTransform::north_up(500000, 5'000'000, 0.506);
  spec.type = GDT_UInt16;
  const ImageryInfo far = inspect_imagery(make_raster(folder / "far.tif", spec));
  EXPECT_THAT(imagery_warnings({a, near}, 0), IsEmpty());
  EXPECT_THAT(imagery_warnings({a, far}, 0), Contains(HasSubstr("1.0120 times")));
  EXPECT_THAT(imagery_warnings({far, a}, 0), Contains(HasSubstr("0.9881 times")));
  EXPECT_THAT(imagery_warnings({a, far}, 0), Contains(HasSubstr("UInt16")));
  EXPECT_THAT(imagery_warnings({a}, 0.6), IsEmpty());
  EXPECT_THAT(imagery_warnings({a}, 0.1), Contains(HasSubstr("coarser than the camera")));
}

}  // namespace
}  // namespace pilotage
