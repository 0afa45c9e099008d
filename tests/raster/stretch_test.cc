#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

Raster raster_of(const cv::Mat& pixels) {
  return {pixels, cv::Mat(pixels.size(), CV_8U, cv::Scalar(255)), {}};
}

TEST(Stretch, FindsThePercentilesOfASmallSourceExactly) {
  Random random(seed_from_name("Stretch"));
  cv::Mat pixels(50, 60, CV_64F);
  std::vector<double> values;
  for (int i = 0; i < 3000; ++i) values.push_back(pixels.at<double>(i / 60, i % 60) = random.normal());
  std::sort(values.begin(), values.end());
  const GrayStretch stretch = find_stretch(gray_source_from(raster_of(pixels)), 2, 98);
  EXPECT_EQ(stretch.low, values[59]);     // the 60th of 3,000
  EXPECT_EQ(stretch.high, values[2939]);  // the 2,940th
}

TEST(Stretch, ReadsASampleOfALargeSource) {
  GraySource source;
  source.width_px = 1'000'000;
  source.height_px = 2'000'000;
  source.depth = CV_16U;
  std::int64_t pixels_read = 0;
  std::int64_t last_col = 0;
  source.read = [&](const PixelWindow& window) {
    pixels_read += std::int64_t{window.width} * window.height;
    last_col = std::max(last_col, window.col + window.width);
    return raster_of(cv::Mat(window.height, window.width, CV_16U, cv::Scalar(static_cast<double>(window.col / 100))));
  };
  const GrayStretch stretch = find_stretch(source, 0, 100);
  EXPECT_EQ(pixels_read, 16 * 16 * 64 * 64);
  EXPECT_EQ(last_col, source.width_px);
  EXPECT_EQ(stretch.low, 0);
  EXPECT_EQ(stretch.high, 9999);
}

TEST(Stretch, LeavesOutWhatIsNotValid) {
  Raster raster = raster_of(cv::Mat(10, 10, CV_16U, cv::Scalar(500)));
  raster.pixels.at<std::uint16_t>(0, 0) = 100;
  raster.pixels.at<std::uint16_t>(5, 5) = 60000;
  raster.valid.at<std::uint8_t>(5, 5) = 0;
  const GrayStretch stretch = find_stretch(gray_source_from(raster), 0, 100);
  EXPECT_EQ(stretch.low, 100);
  EXPECT_EQ(stretch.high, 500);
}

TEST(Stretch, FlatAndEmptySourcesHaveOneToo) {
  Raster raster = raster_of(cv::Mat(10, 10, CV_64F, cv::Scalar(-7)));
  EXPECT_EQ(find_stretch(gray_source_from(raster)).low, -7);
  EXPECT_EQ(find_stretch(gray_source_from(raster)).high, -6);
  raster.pixels.at<double>(1, 1) = 3;  // one in a hundred, which the 98th percentile misses
  EXPECT_EQ(find_stretch(gray_source_from(raster), 2, 98).high, 3);
  raster.valid.setTo(0);
  EXPECT_EQ(find_stretch(gray_source_from(raster)).low, 0);
  EXPECT_EQ(find_stretch(gray_source_from(raster)).high, 1);
}

TEST(Stretch, MapsLinearly) {
  const cv::Mat pixels = (cv::Mat_<double>(1, 7) << -1, 10, 15, 20, 99, NAN, 10.02);
  const cv::Mat bytes = apply_stretch(pixels, {10, 20});
  const std::vector<int> expected{0, 0, 128, 255, 255, 0, 1};
  for (int i = 0; i < 7; ++i) EXPECT_EQ(bytes.at<std::uint8_t>(0, i), expected[static_cast<std::size_t>(i)]) << i;
}

TEST(Stretch, EightBitsAreLeftAlone) {
  const GraySource bytes = gray_source_from(raster_of(cv::Mat(10, 10, CV_8U, cv::Scalar(17))));
  EXPECT_EQ(stretch_to_8bit(bytes).read({0, 0, 10, 10}).pixels.at<std::uint8_t>(3, 3), 17);

  cv::Mat ramp(64, 256, CV_16U);
  for (int i = 0; i < 64 * 256; ++i)
    ramp.at<std::uint16_t>(i / 256, i % 256) = static_cast<std::uint16_t>(1000 + i % 256 * 10);
  const GraySource stretched = stretch_to_8bit(gray_source_from(raster_of(ramp)), 0, 100);
  EXPECT_EQ(stretched.depth, CV_8U);
  const Raster part = stretched.read({100, 3, 20, 20});
  EXPECT_EQ(part.pixels.type(), CV_8U);
  EXPECT_EQ(part.pixels.at<std::uint8_t>(0, 0), 100);
}

TEST(Stretch, BadPercentagesAreRefused) {
  const GraySource source = gray_source_from(raster_of(cv::Mat(10, 10, CV_64F, cv::Scalar(1))));
  EXPECT_THROW(find_stretch(source, -1, 50), UsageError);
  EXPECT_THROW(find_stretch(source, 50, 50), UsageError);
  EXPECT_THROW(find_stretch(source, 50, 101), UsageError);
  EXPECT_THROW(find_stretch(source, NAN, 50), UsageError);
}

TEST(ValidFraction, CountsPixels) {
  Raster raster = raster_of(cv::Mat(10, 10, CV_8U, cv::Scalar(1)));
  raster.valid(cv::Rect(0, 0, 5, 2)).setTo(0);
  EXPECT_EQ(valid_fraction(raster.valid), 0.9);
  EXPECT_EQ(valid_fraction(gray_source_from(raster), {0, 0, 5, 4}), 0.5);
  EXPECT_EQ(valid_fraction(cv::Mat()), 0);
}

}  // namespace
}  // namespace pilotage
