#include "pilotage/matchability/ground_cover.h"

#include <cmath>
#include <numbers>

#include "testing/color_source_from.h"
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

constexpr int kGroundSide_px = 384;

/// One colour with grain: independent noise of every pixel, the same in all bands.
cv::Mat ground(const cv::Scalar& rgb, double grain, std::uint64_t seed) {
  Random random(seed);
  cv::Mat pixels(kGroundSide_px, kGroundSide_px, CV_8UC3);
  for (int row = 0; row < kGroundSide_px; ++row) {
    for (int col = 0; col < kGroundSide_px; ++col) {
      const double noise = grain * random.uniform(-1.7, 1.7);
      for (int band = 0; band < 3; ++band) {
        pixels.at<cv::Vec3b>(row, col)[band] = cv::saturate_cast<std::uint8_t>(rgb[band] + noise);
      }
    }
  }
  return pixels;
}

Raster whole(const cv::Mat& pixels) {
  return {pixels, cv::Mat(pixels.size(), CV_8U, cv::Scalar(255)), {}};
}

TileMatrix matrix_of(const cv::Mat& pixels, int size_px = 128, int stride_px = 64) {
  return {0, {}, pixels.cols, pixels.rows, size_px, stride_px};
}

/// Of the tile in the middle.
GroundCover middle(const Raster& raster) {
  const TileMatrix matrix = matrix_of(raster.pixels);
  const std::int64_t index = matrix.matrix_height() / 2 * matrix.matrix_width() + matrix.matrix_width() / 2;
  return measure_ground_cover(testing::color_source_from(raster), matrix, std::vector<std::int64_t>{index}).front();
}

cv::Mat stripes(double period_px, double angle_deg) {
  cv::Mat gray(kGroundSide_px, kGroundSide_px, CV_8U);
  const double angle = angle_deg * std::numbers::pi / 180;
  for (int row = 0; row < kGroundSide_px; ++row) {
    for (int col = 0; col < kGroundSide_px; ++col) {
      const double along = col * std::cos(angle) + row * std::sin(angle);
      gray.at<std::uint8_t>(row, col) =
          static_cast<std::uint8_t>(std::lround(128 + 60 * std::sin(2 * std::numbers::pi * along / period_px)));
    }
  }
  return gray;
}

TEST(GroundCover, TellsForestWaterAndEarth) {
  const GroundCover forest = middle(whole(ground({50, 72, 46}, 12, 1)));
  EXPECT_GT(forest.vegetation_share, 0.97);
  EXPECT_EQ(forest.water_share, 0);
  const GroundCover lake = middle(whole(ground({77, 90, 92}, 1.2, 2)));
  EXPECT_GT(lake.water_share, 0.99);
  EXPECT_LT(lake.vegetation_share, 0.01) << "greenish water is water";
  const GroundCover earth = middle(whole(ground({170, 160, 145}, 1.2, 3)));
  EXPECT_EQ(earth.water_share, 0) << "smooth, but red and bright";
  EXPECT_EQ(earth.vegetation_share, 0);
  const GroundCover roofs = middle(whole(ground({90, 100, 110}, 15, 4)));
  EXPECT_EQ(roofs.water_share, 0) << "blue and dark, but rough";
}

TEST(GroundCover, SharesAreShares) {
  cv::Mat pixels = ground({77, 90, 92}, 1.2, 5);
  const cv::Rect left(0, 0, kGroundSide_px / 2, kGroundSide_px);
  ground({50, 72, 46}, 12, 6)(left).copyTo(pixels(left));
  const GroundCover half = middle(whole(pixels));
  EXPECT_NEAR(half.vegetation_share, 0.5, 0.03);
  EXPECT_NEAR(half.water_share, 0.5, 0.1) << "the shore is lost to the windows that look at the surroundings";

  Raster holes = whole(pixels);
  holes.valid(left).setTo(0);
  holes.pixels(left).setTo(cv::Scalar(0, 255, 0));  // what stands where there is no ground means nothing
  const GroundCover water = middle(holes);
  EXPECT_EQ(water.vegetation_share, 0);
  EXPECT_GT(water.water_share, 0.99);
}

TEST(GroundCover, SmallSmoothPlacesAreNoWater) {
  cv::Mat pixels = ground({90, 100, 110}, 15, 7);
  for (int row = 10; row < kGroundSide_px; row += 60) {
    for (int col = 10; col < kGroundSide_px; col += 60)
      pixels(cv::Rect(col, row, 14, 14) & cv::Rect(0, 0, kGroundSide_px, kGroundSide_px))
          .setTo(cv::Scalar(80, 90, 100));
  }
  EXPECT_EQ(middle(whole(pixels)).water_share, 0);
}

TEST(GroundCover, GrayKnowsWaterOnly) {
  cv::Mat dark(kGroundSide_px, kGroundSide_px, CV_8U, cv::Scalar(40));
  cv::Mat bright(kGroundSide_px, kGroundSide_px, CV_8U, cv::Scalar(140));
  EXPECT_TRUE(std::isnan(middle(whole(dark)).vegetation_share));
  EXPECT_EQ(middle(whole(dark)).water_share, 1);
  EXPECT_EQ(middle(whole(bright)).water_share, 0);
  EXPECT_TRUE(std::isnan(middle(whole(dark)).aperture)) << "no gradient, no direction";
  // Gray stored in three bands is gray too.
  cv::Mat three;
  cv::cvtColor(bright, three, cv::COLOR_GRAY2RGB);
  EXPECT_TRUE(std::isnan(middle(whole(three)).vegetation_share));
}

TEST(GroundCover, DepthDoesNotMatter) {
  const cv::Mat pixels = ground({50, 72, 46}, 12, 8);
  for (const int depth : {CV_16U, CV_64F}) {
    cv::Mat deep;
    pixels.convertTo(deep, CV_MAKETYPE(depth, 3), depth == CV_16U ? 40 : 1e-3);
    const GroundCover cover = middle(whole(deep));
    EXPECT_GT(cover.vegetation_share, 0.97);
    EXPECT_EQ(cover.water_share, 0);
  }
}

TEST(GroundCover, ApertureIsZeroForStripesAndOneForNoise) {
  for (const double angle : {0.0, 30.0, 77.0}) EXPECT_LT(middle(whole(stripes(14, angle))).aperture, 0.02) << angle;
  const cv::Mat checks = (stripes(14, 0) / 2) + (stripes(14, 90) / 2);
  EXPECT_GT(middle(whole(checks)).aperture, 0.9);
  EXPECT_GT(middle(whole(ground({120, 110, 100}, 20, 9))).aperture, 0.8);
}

TEST(GroundCover, TheEdgeOfTheImageryIsNoEdge) {
  // Earth whose grain has no direction, cut by no data: the cut must not count as structure.
  Raster raster = whole(ground({120, 110, 100}, 8, 10));
  raster.valid(cv::Rect(0, 0, kGroundSide_px / 2 + 3, kGroundSide_px)).setTo(0);
  raster.pixels(cv::Rect(0, 0, kGroundSide_px / 2 + 3, kGroundSide_px)).setTo(cv::Scalar::all(0));
  EXPECT_GT(middle(raster).aperture, 0.7);
}

TEST(GroundCover, DependsNeitherOnThreadsNorOnNeighbours) {
  cv::Mat pixels;
  const cv::Mat tile = ground({70, 84, 76}, 5, 11);
  cv::repeat(tile, 4, 4, pixels);  // several groups
  for (int row = 0; row < pixels.rows; row += 2) pixels.row(row) += cv::Scalar(0, row % 40, 0);
  const ColorSource source = testing::color_source_from(whole(pixels));
  const TileMatrix matrix = matrix_of(pixels, 200, 130);
  const std::vector<GroundCover> all = measure_ground_cover(source, matrix, {}, 1);
  ASSERT_EQ(all.size(), static_cast<std::size_t>(matrix.tile_count()));
  const std::vector<GroundCover> parallel = measure_ground_cover(source, matrix, {}, 4);
  for (std::size_t i = 0; i < all.size(); ++i) {
    const GroundCover alone =
        measure_ground_cover(source, matrix, std::vector<std::int64_t>{static_cast<std::int64_t>(i)}).front();
    for (const GroundCover& other : {parallel[i], alone}) {
      EXPECT_EQ(other.vegetation_share, all[i].vegetation_share) << i;
      EXPECT_EQ(other.water_share, all[i].water_share) << i;
      EXPECT_EQ(other.aperture, all[i].aperture) << i;
    }
  }
}

TEST(GroundCover, RefusesWhatDoesNotFit) {
  const ColorSource source = testing::color_source_from(whole(ground({1, 2, 3}, 0, 12)));
  TileMatrix matrix = matrix_of(cv::Mat(kGroundSide_px, kGroundSide_px, CV_8U));
  EXPECT_THROW(measure_ground_cover(source, matrix, std::vector<std::int64_t>{-1}), UsageError);
  EXPECT_THROW(measure_ground_cover(source, matrix, std::vector<std::int64_t>{matrix.tile_count()}), UsageError);
  ++matrix.grid_width_px;
  EXPECT_THROW(measure_ground_cover(source, matrix, {}), DataError);
}

}  // namespace
}  // namespace pilotage
