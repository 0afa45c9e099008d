#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <string>

#include "testing/temporary_folder.h"
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/raster/gdal_geotiff.h"

namespace pilotage {
namespace {

Raster noise_raster(int type, int width, int height) {
  Random random(seed_from_name("geotiff"));
  Raster raster;
  raster.pixels = cv::Mat(height, width, type);
  raster.valid = cv::Mat(height, width, CV_8U, cv::Scalar(255));
  raster.map_from_pixel = {593250, 0.5, 0.125, 6152460, 0.25, -0.5};
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      if (type == CV_32F) {
        raster.pixels.at<float>(row, col) = static_cast<float>(random.normal());
      } else {
        for (int band = 0; band < 3; ++band) {
          raster.pixels.at<cv::Vec3b>(row, col)[band] = static_cast<unsigned char>(random.below(256));
        }
      }
    }
  }
  return raster;
}

struct Closer {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using Dataset = std::unique_ptr<GDALDataset, Closer>;

Dataset open(const std::filesystem::path& path) {
  GDALAllRegister();
  return Dataset(static_cast<GDALDataset*>(GDALOpen(path.c_str(), GA_ReadOnly)));
}

TEST(Geotiff, Rgb8ComesBackExactlyThroughDeflate) {
  const testing::TemporaryFolder folder;
  Raster raster = noise_raster(CV_8UC3, 300, 270);
  raster.valid(cv::Rect(0, 0, 20, 30)) = 0;
  GeotiffOptions options;
  options.metadata = {{"TIFFTAG_DATETIME", "2023:06:14 09:40:00"}};
  write_rgb8_geotiff(folder / "a.tif", raster, "EPSG:32633", options);
  const Dataset dataset = open(folder / "a.tif");
  ASSERT_TRUE(dataset);
  std::array<double, 6> transform{};
  ASSERT_EQ(dataset->GetGeoTransform(transform.data()), CE_None);
  EXPECT_THAT(transform, ::testing::ElementsAre(593250, 0.5, 0.125, 6152460, 0.25, -0.5));
  EXPECT_THAT(dataset->GetProjectionRef(), ::testing::HasSubstr("UTM zone 33N"));
  EXPECT_STREQ(dataset->GetMetadataItem("TIFFTAG_DATETIME"), "2023:06:14 09:40:00");
  cv::Mat pixels(270, 300, CV_8UC3);
  ASSERT_EQ(dataset->RasterIO(GF_Read, 0, 0, 300, 270, pixels.data, 300, 270, GDT_Byte, 3, nullptr, 3, 900, 1, nullptr),
            CE_None);
  EXPECT_EQ(cv::norm(pixels, raster.pixels, cv::NORM_INF), 0);
  cv::Mat valid(270, 300, CV_8U);
  ASSERT_EQ(dataset->GetRasterBand(2)->GetMaskBand()->RasterIO(GF_Read, 0, 0, 300, 270, valid.data, 300, 270, GDT_Byte,
                                                               1, 300, nullptr),
            CE_None);
  EXPECT_EQ(cv::norm(valid, raster.valid, cv::NORM_INF), 0);
}

TEST(Geotiff, AWindowOfAnotherRasterIsWrittenByItsOwnRows) {
  const testing::TemporaryFolder folder;
  const Raster whole = noise_raster(CV_8UC3, 60, 50);
  Raster part = whole;
  part.pixels = whole.pixels(cv::Rect(7, 9, 20, 11));
  part.valid = whole.valid(cv::Rect(7, 9, 20, 11));
  write_rgb8_geotiff(folder / "part.tif", part, "EPSG:32633");
  const Dataset dataset = open(folder / "part.tif");
  ASSERT_TRUE(dataset);
  cv::Mat pixels(11, 20, CV_8UC3);
  ASSERT_EQ(dataset->RasterIO(GF_Read, 0, 0, 20, 11, pixels.data, 20, 11, GDT_Byte, 3, nullptr, 3, 60, 1, nullptr),
            CE_None);
  EXPECT_EQ(cv::norm(pixels, part.pixels, cv::NORM_INF), 0);
}

TEST(Geotiff, FloatsComeBackExactlyAndGapsAreNoData) {
  const testing::TemporaryFolder folder;
  Raster raster = noise_raster(CV_32F, 40, 30);
  raster.valid.at<unsigned char>(3, 4) = 0;
  write_float32_geotiff(folder / "f.tif", raster, "EPSG:32633");
  const Dataset dataset = open(folder / "f.tif");
  ASSERT_TRUE(dataset);
  int has_no_data = 0;
  EXPECT_TRUE(std::isnan(dataset->GetRasterBand(1)->GetNoDataValue(&has_no_data)));
  EXPECT_EQ(has_no_data, 1);
  cv::Mat values(30, 40, CV_32F);
  ASSERT_EQ(dataset->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, 40, 30, values.data, 40, 30, GDT_Float32, 0, 0, nullptr),
            CE_None);
  EXPECT_TRUE(std::isnan(values.at<float>(3, 4)));
  values.at<float>(3, 4) = raster.pixels.at<float>(3, 4);
  EXPECT_EQ(cv::norm(values, raster.pixels, cv::NORM_INF), 0);
}

TEST(Geotiff, JpegIsCloseAndSmallAndTheSameBytesTwice) {
  const testing::TemporaryFolder folder;
  Raster raster = noise_raster(CV_8UC3, 256, 256);
  for (int row = 0; row < 256; ++row) {
    for (int col = 0; col < 256; ++col) {
      const auto level = static_cast<unsigned char>((row + col) / 2);
      raster.pixels.at<cv::Vec3b>(row, col) = {level, level, level};
    }
  }
  GeotiffOptions options;
  options.compression = GeotiffCompression::kJpeg;
  write_rgb8_geotiff(folder / "a.tif", raster, "EPSG:32633", options);
  write_rgb8_geotiff(folder / "b.tif", raster, "EPSG:32633", options);
  EXPECT_EQ(read_file(folder / "a.tif"), read_file(folder / "b.tif"));
  EXPECT_LT(std::filesystem::file_size(folder / "a.tif"), 256U * 256U * 3U / 5U);
  const Dataset dataset = open(folder / "a.tif");
  ASSERT_TRUE(dataset);
  cv::Mat pixels(256, 256, CV_8UC3);
  ASSERT_EQ(dataset->RasterIO(GF_Read, 0, 0, 256, 256, pixels.data, 256, 256, GDT_Byte, 3, nullptr, 3, 768, 1, nullptr),
            CE_None);
  EXPECT_LE(cv::norm(pixels, raster.pixels, cv::NORM_INF), 6);
}

TEST(Geotiff, WhatCannotBeWrittenIsRefusedAndLeavesNothing) {
  const testing::TemporaryFolder folder;
  const Raster rgb = noise_raster(CV_8UC3, 8, 8);
  const Raster heights = noise_raster(CV_32F, 8, 8);
  GeotiffOptions jpeg;
  jpeg.compression = GeotiffCompression::kJpeg;
  EXPECT_THROW(write_rgb8_geotiff(folder / "x.tif", heights, "EPSG:32633"), UsageError);
  EXPECT_THROW(write_float32_geotiff(folder / "x.tif", rgb, "EPSG:32633"), UsageError);
  EXPECT_THROW(write_float32_geotiff(folder / "x.tif", heights, "EPSG:32633", jpeg), UsageError);
  EXPECT_THROW(write_rgb8_geotiff(folder / "x.tif", rgb, "EPSG:999999"), UsageError);
  EXPECT_THROW(write_rgb8_geotiff(folder / "none" / "x.tif", rgb, "EPSG:32633"), DataError);
  jpeg.jpeg_quality = 0;
  EXPECT_THROW(write_rgb8_geotiff(folder / "x.tif", rgb, "EPSG:32633", jpeg), UsageError);
  Raster no_mask = rgb;
  no_mask.valid = cv::Mat();
  EXPECT_THROW(write_rgb8_geotiff(folder / "x.tif", no_mask, "EPSG:32633"), UsageError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  write_rgb8_geotiff(folder / "x.tif", rgb, "EPSG:32633");
  const std::string before = read_file(folder / "x.tif");
  EXPECT_THROW(write_rgb8_geotiff(folder / "x.tif", rgb, "EPSG:32633"), DataError);
  EXPECT_EQ(read_file(folder / "x.tif"), before);
  write_float32_geotiff(folder / "x.tif", heights, "EPSG:32633", {}, true);
  EXPECT_NE(read_file(folder / "x.tif"), before);
}

}  // namespace
}  // namespace pilotage
