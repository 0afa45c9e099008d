#include "raster/raster_maker.h"
#include "testing/color_source_from.h"
#include "testing/read_all.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/raster/color_source.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

using testing::make_raster;
using testing::RasterSpec;
using testing::read_all;
using testing::TemporaryFolder;
using testing::utm33;

RasterSpec colors_of(GDALDataType type, double red) {
  RasterSpec spec;
  spec.bands = 3;
  spec.type = type;
  spec.creation_options = {"PHOTOMETRIC=RGB"};
  spec.value = [red](int band, int col, int row) { return red / (band + 1) + (col % 5) + (row % 3); };
  return spec;
}

TEST(Colors, KeepTheirDepthAndTheirRatios) {
  const TemporaryFolder folder;
  struct Case {
    GDALDataType type;
    int depth;
    double red;
  };
  for (const Case& one : {Case{GDT_Byte, CV_8U, 120}, Case{GDT_UInt16, CV_16U, 6000}, Case{GDT_Float32, CV_64F, 0.5}}) {
    const RasterSpec spec = colors_of(one.type, one.red);
    const std::string path = make_raster(folder / ("c" + std::to_string(one.depth) + ".tif"), spec);
    const ColorSource own = open_colors(path);
    const ColorSource grid = open_colors_on_grid({path}, utm33(), spec.place, 60, 40);
    for (const ColorSource& source : {own, grid}) {
      EXPECT_EQ(source.channels, 3);
      EXPECT_EQ(source.depth, one.depth);
      const Raster raster = read_all(source);
      ASSERT_EQ(raster.pixels.type(), CV_MAKETYPE(one.depth, 3));
      cv::Mat wide;
      raster.pixels.convertTo(wide, CV_64F);
      const auto pixel = wide.at<cv::Vec3d>(6, 10);  // its column and row add nothing
      EXPECT_NEAR(pixel[0], one.red, 1e-6);
      EXPECT_NEAR(pixel[1], one.red / 2, 1e-6);
      EXPECT_NEAR(pixel[2], one.red / 3, 1e-6);
      EXPECT_EQ(cv::countNonZero(raster.valid), 60 * 40);
    }
    // The gray of colours is what the readers of gray give.
    const Raster gray = gray_source_of(grid).read({3, 4, 20, 10});
    const Raster expected = open_gray_on_grid({path}, utm33(), spec.place, 60, 40).read({3, 4, 20, 10});
    EXPECT_EQ(cv::norm(gray.pixels, expected.pixels, cv::NORM_INF), 0);
    EXPECT_EQ(gray.pixels.type(), expected.pixels.type());
  }
}

TEST(Colors, OneBandHasNone) {
  const TemporaryFolder folder;
  RasterSpec spec;
  const std::string gray = make_raster(folder / "gray.tif", spec);
  EXPECT_EQ(open_colors(gray).channels, 1);
  EXPECT_EQ(read_all(open_colors(gray)).pixels.type(), CV_8UC1);

  // Among colours it shows three equal bands.
  const std::string colored = make_raster(folder / "colored.tif", colors_of(GDT_Byte, 120));
  const ColorSource mosaic = open_colors_on_grid({colored, gray}, utm33(), spec.place, 60, 40);
  EXPECT_EQ(mosaic.channels, 3);
  const auto pixel = read_all(mosaic).pixels.at<cv::Vec3b>(6, 11);
  EXPECT_EQ(pixel[0], (11 * 3 + 6 * 7) % 251);
  EXPECT_EQ(pixel[0], pixel[1]);
  EXPECT_EQ(pixel[1], pixel[2]);
}

// Parts that are alike share their blocks; the others must not, or the gray of 8 bits would lose its rounding.
TEST(Colors, OpenedWithTheirGrayTheyAreTheSamePixels) {
  const TemporaryFolder folder;
  const RasterSpec place;
  const std::string bytes = make_raster(folder / "bytes.tif", colors_of(GDT_Byte, 121));
  RasterSpec other = colors_of(GDT_Byte, 76);
  other.place.origin_x += 20 * other.place.x_per_col;
  const std::string more_bytes = make_raster(folder / "more.tif", other);
  const std::string floats = make_raster(folder / "floats.tif", colors_of(GDT_Float32, 0.7));
  const std::string gray = make_raster(folder / "gray.tif", RasterSpec());
  using Parts = std::vector<std::string>;
  for (const Parts& parts :
       {Parts{bytes}, Parts{bytes, more_bytes}, Parts{floats}, Parts{gray}, Parts{floats, bytes}, Parts{bytes, gray}}) {
    const GrayAndColors both = open_gray_and_colors_on_grid(parts, utm33(), place.place, 90, 50, {}, 1 << 20);
    const GraySource gray_alone = open_gray_on_grid(parts, utm33(), place.place, 90, 50);
    const ColorSource colors_alone = open_colors_on_grid(parts, utm33(), place.place, 90, 50);
    EXPECT_EQ(both.gray.block_width_px, gray_alone.block_width_px);
    for (const PixelWindow& window : {PixelWindow{0, 0, 90, 50}, PixelWindow{7, 5, 40, 30}}) {
      const Raster as_gray = both.gray.read(window);
      const Raster expected_gray = gray_alone.read(window);
      ASSERT_EQ(as_gray.pixels.type(), expected_gray.pixels.type());
      EXPECT_EQ(cv::norm(as_gray.pixels, expected_gray.pixels, cv::NORM_INF), 0) << parts.size() << parts.front();
      EXPECT_EQ(cv::norm(as_gray.valid, expected_gray.valid, cv::NORM_INF), 0);
      EXPECT_EQ(as_gray.map_from_pixel.origin_x, expected_gray.map_from_pixel.origin_x);
      const Raster as_colors = both.colors.read(window);
      const Raster expected_colors = colors_alone.read(window);
      ASSERT_EQ(as_colors.pixels.type(), expected_colors.pixels.type());
      EXPECT_EQ(cv::norm(as_colors.pixels, expected_colors.pixels, cv::NORM_INF), 0) << parts.size() << parts.front();
      EXPECT_EQ(cv::norm(as_colors.valid, expected_colors.valid, cv::NORM_INF), 0);
    }
  }
}

TEST(Colors, NotFiniteIsNoGroundAndWindowsStayInside) {
  const TemporaryFolder folder;
  RasterSpec spec = colors_of(GDT_Float32, 1);
  spec.value = [](int band, int col, int) { return band == 1 && col < 7 ? std::nan("") : 1.0; };
  const ColorSource source = open_colors(make_raster(folder / "holes.tif", spec));
  EXPECT_EQ(cv::countNonZero(read_all(source).valid), 53 * 40);
  EXPECT_THROW(source.read({50, 0, 11, 4}), UsageError);
}

TEST(Colors, InMemory) {
  const cv::Mat pixels(8, 9, CV_16UC3, cv::Scalar(1, 2, 3));
  const ColorSource source = testing::color_source_from({pixels, cv::Mat(8, 9, CV_8U, cv::Scalar(255)), {}});
  EXPECT_EQ(source.width_px, 9);
  EXPECT_EQ(source.height_px, 8);
  EXPECT_EQ(source.channels, 3);
  EXPECT_EQ(source.depth, CV_16U);
  EXPECT_EQ(source.read({1, 2, 3, 4}).pixels.size(), cv::Size(3, 4));
}

}  // namespace
}  // namespace pilotage
