#include "pilotage/camera/sampled_ground.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include "camera/plain_sampling.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

Raster noise(int width_px, int height_px) {
  Random random(7);
  Raster raster{cv::Mat(height_px, width_px, CV_8UC1), cv::Mat(height_px, width_px, CV_8UC1, cv::Scalar(255)), {}};
  for (auto gray = raster.pixels.begin<std::uint8_t>(); gray != raster.pixels.end<std::uint8_t>(); ++gray) {
    *gray = static_cast<std::uint8_t>(256 * random.uniform());
  }
  return raster;
}

/// Corners that lie apart by what `side_px` says of each column, on a line that climbs.
CornerLine line_of(double x_px, double y_px, const std::vector<double>& sides_px) {
  CornerLine line{{x_px}, {y_px}};
  for (const double side_px : sides_px) {
    line.x_px.push_back(line.x_px.back() + side_px);
    line.y_px.push_back(line.y_px.back() + 0.07 * side_px);
  }
  return line;
}

Eigen::Vector2d corner(const CornerLine& line, std::size_t i) {
  return {line.x_px[i], line.y_px[i]};
}

/// Every mean is the plain one. Returns how many there are.
int expect_plain_means(const Raster& ground, const CornerLine& above, const CornerLine& below) {
  std::vector<double> means(above.x_px.size() - 1);
  SampledGround(ground).means_between(above, below, means);
  int known = 0;
  for (std::size_t i = 0; i < means.size(); ++i) {
    const double plain =
        testing::plain_mean(ground, corner(above, i), corner(above, i + 1), corner(below, i), corner(below, i + 1));
    EXPECT_EQ(std::isnan(means[i]), std::isnan(plain)) << i;
    const CornerLine alone_above{{above.x_px[i], above.x_px[i + 1]}, {above.y_px[i], above.y_px[i + 1]}};
    const CornerLine alone_below{{below.x_px[i], below.x_px[i + 1]}, {below.y_px[i], below.y_px[i + 1]}};
    std::vector<double> alone(1);
    SampledGround(ground).means_between(alone_above, alone_below, alone);
    EXPECT_TRUE(alone[0] == means[i] || std::isnan(plain)) << i << ": other pixels stand beside it";
    if (std::isnan(plain)) continue;
    EXPECT_NEAR(means[i], plain, 1e-10) << i;
    ++known;
  }
  return known;
}

TEST(SampledGround, MeansAreThoseOfEachSampleAlone) {
  const Raster ground = noise(90, 60);
  const std::vector<double> fine(83, 0.83);
  EXPECT_EQ(expect_plain_means(ground, line_of(4.3, 8.1, fine), line_of(4.2, 8.9, fine)), 83)
      << "cubic, 83 = 10 · 8 + 3";
  const std::vector<double> coarse(27, 2.6);
  EXPECT_EQ(expect_plain_means(ground, line_of(4.3, 8.1, coarse), line_of(4.4, 10.7, coarse)), 27) << "linear";
  std::vector<double> mixed;
  for (int i = 0; i < 30; ++i) mixed.push_back(0.2 + 0.13 * i);
  EXPECT_EQ(expect_plain_means(ground, line_of(4.3, 20.1, mixed), line_of(4.2, 20.9, mixed)), 30)
      << "neighbours that take other numbers of samples";
}

TEST(SampledGround, WhatIsMissingIsMissingForThatPixelAlone) {
  Raster ground = noise(90, 60);
  ground.valid.at<std::uint8_t>(10, 30) = 0;
  const std::vector<double> fine(110, 0.9);
  CornerLine above = line_of(-3.5, 9.1, fine);  // from beyond the left edge to beyond the right one
  CornerLine below = line_of(-3.5, 9.9, fine);
  above.x_px[50] = kNaN;
  below.y_px[71] = kNaN;
  const int known = expect_plain_means(ground, above, below);
  EXPECT_GT(known, 75);
  EXPECT_LT(known, 95);
  const std::vector<double> coarse(30, 3.1);
  EXPECT_GT(expect_plain_means(ground, line_of(-1, 8, coarse), line_of(-1, 11, coarse)), 20) << "linear";
  EXPECT_EQ(expect_plain_means(ground, line_of(5, 58.1, fine), line_of(5, 58.9, fine)), 0) << "along the lower edge";
  const int climbing = expect_plain_means(ground, line_of(5, 0.1, fine), line_of(5, 0.9, fine));
  EXPECT_GT(climbing, 60) << "from the upper edge away";
  EXPECT_LT(climbing, 80);
  EXPECT_EQ(expect_plain_means(ground, line_of(-1e300, 9, {2e300}), line_of(-1e300, 10, {2e300})), 0);
  const Raster least = noise(4, 4);
  EXPECT_EQ(expect_plain_means(least, line_of(1.6, 1.6, {0.5}), line_of(1.6, 2.1, {0.5})), 1);
  const Raster tiny = noise(3, 3);
  EXPECT_EQ(expect_plain_means(tiny, line_of(1, 1, {0.1}), line_of(1, 1.1, {0.1})), 0)
      << "less than the kernel is wide";
}

}  // namespace
}  // namespace pilotage
