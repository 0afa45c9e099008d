#include <algorithm>
#include <cmath>
#include <ostream>
#include <string_view>

#include "testing/temporary_folder.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"
#include "pilotage/raster/mission_crs.h"

namespace pilotage {
namespace {

/// Numbers from rasterio and numpy (docs/methods/imagery.md has the program), none of which is ours.
struct RealRaster {
  const char* file;
  std::int64_t width_px;
  std::int64_t height_px;
  double valid_pixels;
  double gray_sum;     ///< Over the valid pixels.
  double center_gray;  ///< At column width / 2, row height / 2.
  double gsd_m;        ///< Along a row: pixel size × unit × cos(latitude) where the CRS stretches.
  double gsd_tolerance;
};

void PrintTo(const RealRaster& raster, std::ostream* out) {
  *out << raster.file;
}

const RealRaster kRasters[] = {
    {"odd/ms1.tif", 300, 300, 90000, 12667052.256000001, 66.12899999999999, 1.0, 1e-3},
    {"odd/pan1.tif", 600, 600, 360000, 71843312.0, 157.0, 0.5, 1e-3},
    {"odd/pan3.tif", 600, 600, 360000, 63945921.0, 250.0, 0.5, 1e-3},
    {"odd/road_mask_input.tif", 1300, 1300, 1690000, 944686000.0, 398.0, 0.243, 1e-3},
    {"odd/sample_geotiff.tif", 900, 900, 810000, 370160351.0, 686.0, 0.5, 1e-3},
    {"odd/sample_geotiff_custom_proj.tif", 512, 512, 262144, 281379245.404, 1676.275, 30, 0.3},
    {"odd/sar_vv.tif", 200, 200, 40000, 51622974.12237513, 1117.1951485752165, 2.5, 0.01},
    {"autzen/autzen.tif", 3248, 4385, 14242480, 1789766782.0, 165.0, 0.3048, 1e-3},
    {"zanzibar/zanzibar_z20.tif", 4096, 2048, 8388608, 1100841834.0, 142.0, 0.14846, 1e-3},
    {"port/port_2019-08.tif", 3953, 3927, 6589896, 625692960.0, 65.0, 0.3, 1e-3},
};

class RealImagery : public ::testing::TestWithParam<RealRaster> {
 protected:
  void SetUp() override {
    const auto folder = testing::real_data_folder();
    if (folder.empty() || !std::filesystem::exists(folder / GetParam().file)) GTEST_SKIP() << testing::kNoRealImagery;
    path_ = (folder / GetParam().file).string();
  }
  std::string path_;
};

double sum_of_valid(const Raster& raster) {
  cv::Mat wide;
  raster.pixels.convertTo(wide, CV_64F);
  wide.setTo(0, raster.valid == 0);
  return cv::sum(wide)[0];
}

TEST_P(RealImagery, GrayAgreesWithNumpy) {
  const RealRaster& expected = GetParam();
  ImageryOptions every_pixel;
  every_pixel.collar = CollarRule::kKeep;
  const GraySource source = open_gray(path_, every_pixel);
  ASSERT_EQ(source.width_px, expected.width_px);
  ASSERT_EQ(source.height_px, expected.height_px);
  double valid = 0;
  double sum = 0;
  for (std::int64_t row = 0; row < source.height_px; row += 500) {
    for (std::int64_t col = 0; col < source.width_px; col += 700) {
      const auto width = static_cast<int>(std::min<std::int64_t>(700, source.width_px - col));
      const auto height = static_cast<int>(std::min<std::int64_t>(500, source.height_px - row));
      const Raster raster = source.read({col, row, width, height});
      valid += cv::countNonZero(raster.valid);
      sum += sum_of_valid(raster);
    }
  }
  EXPECT_EQ(valid, expected.valid_pixels);
  EXPECT_NEAR(sum, expected.gray_sum, 1e-11 * expected.gray_sum);
  EXPECT_NEAR(sum_of_valid(source.read({source.width_px / 2, source.height_px / 2, 1, 1})), expected.center_gray,
              1e-11);
}

// Only pan3 has a collar: black above the edge of the scene.
TEST_P(RealImagery, CollarsAreThoseThatOneSees) {
  const RealRaster& expected = GetParam();
  const GraySource source = open_gray(path_);
  const Raster raster = source.read({0, 0, static_cast<int>(std::min<std::int64_t>(source.width_px, 600)), 200});
  const int valid = cv::countNonZero(raster.valid);
  if (std::string_view(expected.file) == "odd/pan3.tif") {
    EXPECT_EQ(valid, 0);
    EXPECT_EQ(cv::countNonZero(source.read({0, 240, 600, 360}).valid), 600 * 360);
  } else {
    EXPECT_EQ(inspect_imagery(path_).collar, nullptr) << expected.file;
  }
}

TEST_P(RealImagery, GoesOntoAMissionGrid) {
  const ImageryInfo info = inspect_imagery(path_);
  EXPECT_NEAR(info.gsd_x_m, GetParam().gsd_m, GetParam().gsd_tolerance);
  const MissionCrs mission = choose_mission_crs({info.center}, 100);
  const Bounds bounds = imagery_bounds(info, mission.crs);
  const double gsd_m = std::max(bounds.width_m(), bounds.height_m()) / 100;
  const GeoTransform place = GeoTransform::north_up(bounds.min_x_m, bounds.max_y_m, gsd_m);
  const Raster own = open_gray(path_).read({0, 0, info.width_px, info.height_px});
  const Raster raster = open_gray_on_grid({path_}, mission.crs, place, 100, 100).read({0, 0, 100, 100});
  // A coarse grid keeps the mean gray and the area (the JPEG overviews of some keep them to a few per cent only).
  const double own_mean = cv::mean(own.pixels, own.valid)[0];
  EXPECT_NEAR(cv::mean(raster.pixels, raster.valid)[0], own_mean, 0.05 * own_mean);
  ImageryOptions centres;  // one sample per pixel: the area has no bias
  centres.resampling = Resampling::kNearest;
  const Raster mask = open_valid_on_grid({path_}, mission.crs, place, 100, 100, centres).read({0, 0, 100, 100});
  const double area_m2 = cv::countNonZero(mask.valid) * gsd_m * gsd_m;
  EXPECT_NEAR(area_m2 / (cv::countNonZero(own.valid) * info.gsd_x_m * info.gsd_y_m), 1, 0.02);
  const Raster picture = read_rgb8_on_grid({path_}, mission.crs, place, 100, 100);
  EXPECT_EQ(picture.pixels.type(), CV_8UC3);
}

INSTANTIATE_TEST_SUITE_P(Files, RealImagery, ::testing::ValuesIn(kRasters), [](const auto& test) {
  std::string name = std::filesystem::path(test.param.file).stem().string();
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
});

TEST(RealImageryWithoutCrs, IsToldWhatIsMissing) {
  const auto folder = testing::real_data_folder();
  if (!std::filesystem::exists(folder / "autzen/autzen.jpg")) GTEST_SKIP() << testing::kNoRealImagery;
  const std::string path = (folder / "autzen/autzen.jpg").string();  // has a world file and no CRS
  EXPECT_THROW(inspect_imagery(path), DataError);
  ImageryOptions options;
  options.imagery_crs = "EPSG:2994";
  EXPECT_NEAR(inspect_imagery(path, options).gsd_x_m, 0.3048, 1e-3);
}

}  // namespace
}  // namespace pilotage
