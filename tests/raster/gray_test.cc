#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/read_all.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using testing::make_raster;
using testing::RasterSpec;
using testing::read_all;
using testing::TemporaryFolder;

double gray_at(const Raster& raster, int col, int row) {
  cv::Mat wide;
  raster.pixels.convertTo(wide, CV_64F);
  return wide.at<double>(row, col);
}

bool valid_at(const Raster& raster, int col, int row) {
  return raster.valid.at<std::uint8_t>(row, col) == 255;
}

struct TypeCase {
  GDALDataType type;
  int depth;
  double low;
  double high;
};

class GrayOfType : public ::testing::TestWithParam<TypeCase> {};

TEST_P(GrayOfType, OneBandIsItsValues) {
  const TemporaryFolder folder;
  const TypeCase& c = GetParam();
  RasterSpec spec;
  spec.type = c.type;
  spec.value = [&](int, int col, int row) { return row == 0 ? c.low : row == 1 ? c.high : col + 100 * (row % 2); };
  const GraySource source = open_gray(make_raster(folder / "a.tif", spec));
  EXPECT_EQ(source.depth, c.depth);
  const Raster raster = read_all(source);
  EXPECT_EQ(raster.pixels.type(), c.depth);
  EXPECT_EQ(gray_at(raster, 5, 0), c.low);
  EXPECT_EQ(gray_at(raster, 5, 1), c.high);
  EXPECT_EQ(gray_at(raster, 5, 3), 105);
  EXPECT_EQ(cv::countNonZero(raster.valid), 60 * 40);
}

TEST_P(GrayOfType, ThreeBandsAreLuma) {
  const TemporaryFolder folder;
  const TypeCase& c = GetParam();
  Random random(seed_from_name("GrayOfType.ThreeBandsAreLuma"));
  std::vector<std::array<double, 3>> colors;
  for (int i = 0; i < 2400; ++i) {
    std::array<double, 3> color{};
    const double high = std::min(c.high, 1e6);
    const double low = std::max(c.low, -1e6);
    for (double& value : color) value = std::floor(random.uniform(low, high + 1));
    colors.push_back(color);
  }
  RasterSpec spec;
  spec.type = c.type;
  spec.bands = 3;
  spec.value = [&](int band, int col, int row) {
    return colors[static_cast<std::size_t>(row * 60 + col)][static_cast<std::size_t>(band)];
  };
  const Raster raster = read_all(open_gray(make_raster(folder / "a.tif", spec)));
  for (int row = 0; row < 40; ++row) {
    for (int col = 0; col < 60; ++col) {
      const auto& [r, g, b] = colors[static_cast<std::size_t>(row * 60 + col)];
      // OpenCV's fixed-point coefficients have 15 bits for bytes and for 16-bit values.
      const bool fixed_point = c.depth != CV_64F;
      const double expected = fixed_point ? std::floor((9798 * r + 19235 * g + 3735 * b + 16384) / 32768)
                                          : 0.299 * r + 0.587 * g + 0.114 * b;
      ASSERT_EQ(gray_at(raster, col, row), expected) << r << " " << g << " " << b;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Types, GrayOfType,
                         ::testing::Values(TypeCase{GDT_Byte, CV_8U, 0, 255}, TypeCase{GDT_UInt16, CV_16U, 0, 65535},
                                           TypeCase{GDT_Int16, CV_64F, -32768, 32767},
                                           TypeCase{GDT_UInt32, CV_64F, 0, 4294967295.0},
                                           TypeCase{GDT_Int32, CV_64F, -2147483648.0, 2147483647.0},
                                           TypeCase{GDT_Float32, CV_64F, -1.5, 0.25},
                                           TypeCase{GDT_Float64, CV_64F, -1e300, 1e300}),
                         [](const auto& test) { return std::string(GDALGetDataTypeName(test.param.type)); });

TEST(Gray, BandsFollowTheirColors) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 4;
  spec.value = [](int band, int, int) { return std::array{10, 200, 100, 50}[static_cast<std::size_t>(band)]; };
  spec.finish = [](GDALDataset& dataset) {  // near-infrared, blue, green, red
    dataset.GetRasterBand(1)->SetColorInterpretation(GCI_Undefined);
    dataset.GetRasterBand(2)->SetColorInterpretation(GCI_BlueBand);
    dataset.GetRasterBand(3)->SetColorInterpretation(GCI_GreenBand);
    dataset.GetRasterBand(4)->SetColorInterpretation(GCI_RedBand);
  };
  const std::string path = make_raster(folder / "a.tif", spec);
  EXPECT_EQ(inspect_imagery(path).gray_bands, (std::vector<int>{4, 3, 2}));
  EXPECT_EQ(gray_at(read_all(open_gray(path)), 0, 0), std::round(0.299 * 50 + 0.587 * 100 + 0.114 * 200));

  ImageryOptions options;
  options.bands = {1};
  EXPECT_EQ(gray_at(read_all(open_gray(path, options)), 0, 0), 10);
  options.bands = {2, 2, 2};
  EXPECT_EQ(gray_at(read_all(open_gray(path, options)), 0, 0), 200);
  options.bands = {1, 2};
  EXPECT_THAT(error_of<std::runtime_error>([&] { open_gray(path, options); }), HasSubstr("bands has 2 values"));
  options.bands = {5};
  EXPECT_THAT(error_of<std::runtime_error>([&] { open_gray(path, options); }), HasSubstr("has bands 1 to 4"));
  options.bands = {1.5};
  EXPECT_THROW(open_gray(path, options), UsageError);
}

TEST(Gray, ManyBandsWithoutColorsAreTheFirstThree) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 5;
  spec.type = GDT_UInt16;
  spec.creation_options = {"PHOTOMETRIC=MINISBLACK", "ALPHA=NO"};
  const std::string path = make_raster(folder / "a.tif", spec);
  EXPECT_EQ(inspect_imagery(path).gray_bands, (std::vector<int>{1, 2, 3}));
}

TEST(Gray, APaletteBecomesColors) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.value = [](int, int col, int) { return col % 4; };
  spec.finish = [](GDALDataset& dataset) {
    GDALColorTable colors;
    const std::array<GDALColorEntry, 4> entries{{{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}, {9, 9, 9, 255}}};
    for (int i = 0; i < 4; ++i) colors.SetColorEntry(i, &entries[static_cast<std::size_t>(i)]);
    dataset.GetRasterBand(1)->SetColorTable(&colors);
  };
  const std::string path = make_raster(folder / "a.tif", spec);
  EXPECT_TRUE(inspect_imagery(path).palette);
  Raster raster = read_all(open_gray(path));
  EXPECT_EQ(gray_at(raster, 0, 0), 76);   // 0.299 · 255
  EXPECT_EQ(gray_at(raster, 1, 0), 150);  // 0.587 · 255
  EXPECT_EQ(gray_at(raster, 2, 0), 29);   // 0.114 · 255
  EXPECT_EQ(gray_at(raster, 3, 0), 9);
  EXPECT_EQ(cv::countNonZero(raster.valid), 60 * 40);

  ImageryOptions options;
  options.nodata = 3;
  raster = read_all(open_gray(path, options));
  EXPECT_TRUE(valid_at(raster, 2, 0));
  EXPECT_FALSE(valid_at(raster, 3, 0));
  testing::change_raster(path, [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(1); });
  EXPECT_FALSE(valid_at(read_all(open_gray(path)), 1, 0));
}

TEST(Gray, WhereZeroIsWhiteValuesAreTurned) {
  const TemporaryFolder folder;
  for (const GDALDataType type : {GDT_Byte, GDT_UInt16}) {
    RasterSpec spec;
    spec.type = type;
    const cv::Mat plain = open_gray(make_raster(folder / "plain.tif", spec)).read({0, 0, 60, 40}).pixels;
    spec.creation_options = {"PHOTOMETRIC=MINISWHITE"};
    const std::string white = make_raster(folder / "white.tif", spec);
    EXPECT_TRUE(inspect_imagery(white).min_is_white);
    const cv::Mat turned = open_gray(white).read({0, 0, 60, 40}).pixels;
    const double largest = type == GDT_Byte ? 255 : 65535;
    EXPECT_EQ(cv::norm(turned, cv::Mat(largest - plain), cv::NORM_INF), 0);
    // Warped onto a grid, too.
    const GeoTransform grid = GeoTransform::north_up(500002, 4'999'998, 0.5);
    const cv::Mat on_grid = open_gray_on_grid({white}, testing::utm33(), grid, 20, 10).read({0, 0, 20, 10}).pixels;
    EXPECT_EQ(cv::norm(on_grid, turned(cv::Rect(4, 4, 20, 10)), cv::NORM_INF), 0);
    for (const char* file : {"plain.tif", "white.tif"}) std::filesystem::remove(folder / file);
  }
}

TEST(Gray, GrayAndAlpha) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 2;
  spec.creation_options = {"ALPHA=YES"};
  spec.value = [](int band, int col, int) { return band == 0 ? col : col < 10 ? 0 : col < 20 ? 1 : 255; };
  const std::string path = make_raster(folder / "a.tif", spec);
  const ImageryInfo info = inspect_imagery(path);
  EXPECT_EQ(info.mask, MaskKind::kAlpha);
  EXPECT_EQ(info.gray_bands, std::vector<int>{1});
  const Raster raster = read_all(open_gray(path));
  EXPECT_FALSE(valid_at(raster, 9, 0));
  EXPECT_TRUE(valid_at(raster, 10, 0));  // hardly opaque, but ground
  EXPECT_EQ(gray_at(raster, 30, 0), 30);
}

TEST(Gray, SixteenBitAlphaMayHoldEightBitValues) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 4;
  spec.type = GDT_UInt16;
  spec.creation_options = {"PHOTOMETRIC=RGB", "ALPHA=YES"};
  spec.value = [](int band, int col, int) { return band < 3 ? 1000 : col < 10 ? 0 : 255; };
  const Raster raster = read_all(open_gray(make_raster(folder / "a.tif", spec)));
  EXPECT_FALSE(valid_at(raster, 9, 0));
  EXPECT_TRUE(valid_at(raster, 10, 0));
}

TEST(Gray, AlphaAndNoDataBothCount) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 2;
  spec.creation_options = {"ALPHA=YES"};
  spec.value = [](int band, int col, int) { return band == 0 ? col : col < 10 ? 0 : 255; };
  spec.finish = [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(42); };
  const Raster raster = read_all(open_gray(make_raster(folder / "a.tif", spec)));
  EXPECT_FALSE(valid_at(raster, 9, 0));
  EXPECT_FALSE(valid_at(raster, 42, 0));
  EXPECT_TRUE(valid_at(raster, 43, 0));
}

TEST(Gray, NoDataOfEightBitColorsNeedsAllChannels) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 3;
  spec.value = [](int band, int col, int) { return col < 10 ? 0 : col < 20 && band > 0 ? 0 : 90; };
  spec.finish = [](GDALDataset& dataset) {
    for (int band = 1; band <= 3; ++band) dataset.GetRasterBand(band)->SetNoDataValue(0);
  };
  Raster raster = read_all(open_gray(make_raster(folder / "a.tif", spec)));
  EXPECT_FALSE(valid_at(raster, 9, 0));
  EXPECT_TRUE(valid_at(raster, 10, 0));  // pure red is a colour
  spec.type = GDT_Int16;
  raster = read_all(open_gray(make_raster(folder / "b.tif", spec)));
  EXPECT_FALSE(valid_at(raster, 9, 0));
  EXPECT_FALSE(valid_at(raster, 10, 0));  // one missing channel spoils the luma
  EXPECT_TRUE(valid_at(raster, 20, 0));
}

TEST(Gray, AMaskBandCounts) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 3;
  const std::string path = make_raster(folder / "a.tif", spec);
  testing::change_raster(path, [](GDALDataset& dataset) {
    ASSERT_EQ(dataset.CreateMaskBand(GMF_PER_DATASET), CE_None);
    std::vector<std::uint8_t> mask(60 * 40, 255);
    for (int i = 0; i < 60; ++i) mask[static_cast<std::size_t>(60 * 3 + i)] = 0;
    ASSERT_EQ(dataset.GetRasterBand(1)->GetMaskBand()->RasterIO(GF_Write, 0, 0, 60, 40, mask.data(), 60, 40, GDT_Byte,
                                                                0, 0, nullptr),
              CE_None);
  });
  EXPECT_EQ(inspect_imagery(path).mask, MaskKind::kMaskBand);
  const Raster raster = read_all(open_gray(path));
  EXPECT_EQ(cv::countNonZero(raster.valid), 60 * 39);
  EXPECT_FALSE(valid_at(raster, 17, 3));
}

TEST(Gray, NotANumberIsNoGround) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.type = GDT_Float32;
  spec.value = [](int, int col, int row) { return col == 7 ? NAN : col == 8 ? INFINITY : row; };
  const std::string path = make_raster(folder / "a.tif", spec);
  const Raster raster = read_all(open_gray(path));
  EXPECT_FALSE(valid_at(raster, 7, 5));
  EXPECT_FALSE(valid_at(raster, 8, 5));
  EXPECT_TRUE(valid_at(raster, 9, 5));
  ImageryOptions options;
  options.nodata = 5;
  EXPECT_FALSE(valid_at(read_all(open_gray(path, options)), 9, 5));
}

TEST(Gray, ComplexValuesBecomeTheirMagnitude) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.type = GDT_CFloat32;
  const std::string path = make_raster(folder / "a.tif", spec);
  testing::change_raster(path, [](GDALDataset& dataset) {
    const std::vector<std::complex<float>> values(60 * 40, {3, -4});
    ASSERT_EQ(
        dataset.GetRasterBand(1)->RasterIO(GF_Write, 0, 0, 60, 40, const_cast<std::complex<float>*>(values.data()), 60,
                                           40, GDT_CFloat32, 0, 0, nullptr),
        CE_None);
  });
  EXPECT_EQ(gray_at(read_all(open_gray(path)), 3, 3), 5);
  EXPECT_THAT(inspect_imagery(path).warnings, ::testing::Contains(HasSubstr("magnitude")));
}

TEST(Gray, WindowsOfARotatedRasterKnowTheirPlace) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.place = {500000, 0.4, 0.3, 5'000'000, 0.3, -0.4};
  const GraySource source = open_gray(make_raster(folder / "a.tif", spec));
  EXPECT_EQ(source.map_from_pixel, spec.place);
  const Raster whole = read_all(source);
  const Raster part = source.read({7, 9, 20, 10});
  EXPECT_EQ(part.map_from_pixel, spec.place.shifted(7, 9));
  EXPECT_EQ(cv::norm(part.pixels, whole.pixels(cv::Rect(7, 9, 20, 10)), cv::NORM_INF), 0);
  for (const PixelWindow& window : {PixelWindow{-1, 0, 5, 5}, {0, 0, 61, 5}, {0, 36, 5, 5}, {0, 0, 0, 5}}) {
    EXPECT_THROW(source.read(window), UsageError);
  }
}

TEST(Gray, ManyThreadsReadTheSame) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.width = 400;
  spec.height = 300;
  spec.bands = 3;
  spec.creation_options = {"TILED=YES", "BLOCKXSIZE=64", "BLOCKYSIZE=64", "COMPRESS=DEFLATE"};
  const GraySource source = open_gray(make_raster(folder / "a.tif", spec));
  const Raster whole = read_all(source);
  for (const int threads : {1, 2, 7}) {
    std::vector<double> differences(300, -1);
    parallel_for(300, threads, [&](std::size_t index, int) {
      Random random(derive_seed(17, index));
      const PixelWindow window{static_cast<std::int64_t>(random.below(300)),
                               static_cast<std::int64_t>(random.below(200)), 100, 100};
      const cv::Rect rect(static_cast<int>(window.col), static_cast<int>(window.row), 100, 100);
      differences[index] = cv::norm(source.read(window).pixels, whole.pixels(rect), cv::NORM_INF);
    });
    EXPECT_EQ(differences, std::vector<double>(300, 0)) << threads;
  }
}

TEST(Gray, MissingAndBrokenFilesAreNamed) {
  const TemporaryFolder folder;
  const std::string missing = (folder / "missing.tif").string();
  EXPECT_THAT(error_of<std::runtime_error>([&] { open_gray(missing); }), HasSubstr(missing));

  write_file(folder / "text.tif", "this is no raster", false);
  EXPECT_THAT(error_of<std::runtime_error>([&] { open_gray((folder / "text.tif").string()); }), HasSubstr("text.tif"));
  write_file(folder / "empty.tif", "", false);
  EXPECT_THAT(error_of<std::runtime_error>([&] { open_gray((folder / "empty.tif").string()); }),
              HasSubstr("empty.tif"));
  EXPECT_THAT(error_of<std::runtime_error>([&] { open_gray(folder.path().string()); }),
              HasSubstr(folder.path().string()));
  EXPECT_NE(error_of<std::runtime_error>([&] { open_gray(""); }), "");
}

TEST(Gray, ATruncatedRasterIsAnErrorAtAnyLength) {
  const TemporaryFolder folder;
  for (const char* compression : {"COMPRESS=NONE", "COMPRESS=DEFLATE", "COMPRESS=LZW", "COMPRESS=JPEG"}) {
    RasterSpec spec;
    spec.width = spec.height = 128;
    spec.creation_options = {"TILED=YES", "BLOCKXSIZE=64", "BLOCKYSIZE=64", compression};
    const std::string whole = read_file(make_raster(folder / "whole.tif", spec));
    const Raster truth = read_all(open_gray((folder / "whole.tif").string()));
    int refused = 0;
    for (std::size_t length = 0; length < whole.size(); length += 1 + whole.size() / 60) {
      write_file(folder / "cut.tif", whole.substr(0, length), true);
      const std::string error = error_of<std::runtime_error>([&] {
        const Raster raster = read_all(open_gray((folder / "cut.tif").string()));
        // What does open must be the truth.
        EXPECT_EQ(cv::norm(raster.pixels, truth.pixels, cv::NORM_INF), 0) << compression << " " << length;
      });
      if (!error.empty()) {
        EXPECT_THAT(error, HasSubstr("cut.tif"));
        ++refused;
      }
    }
    EXPECT_GT(refused, 50) << compression;
  }
}

TEST(Gray, NothingIsPrinted) {
  const TemporaryFolder folder;
  ::testing::internal::CaptureStderr();
  ::testing::internal::CaptureStdout();
  error_of<std::runtime_error>([&] { open_gray((folder / "missing.tif").string()); });
  error_of<std::runtime_error>([&] { Crs::from_user_input("PROJCS[\"broken\""); });
  error_of<std::runtime_error>([&] { inspect_imagery(make_raster(folder / "a.tif", {.georeferenced = false})); });
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
}

}  // namespace
}  // namespace pilotage
