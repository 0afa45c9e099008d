#include "pilotage/simulate/bad_frame.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace pilotage {
namespace {

/// Gray values between 40 and 160, of fine texture.
cv::Mat ground() {
  cv::Mat gray(240, 320, CV_8UC1);
  Random random(7);
  for (auto pixel = gray.begin<std::uint8_t>(); pixel != gray.end<std::uint8_t>(); ++pixel) {
    *pixel = static_cast<std::uint8_t>(40 + random.below(121));
  }
  return gray;
}

double sigma_of(const cv::Mat& gray) {
  cv::Scalar mean;
  cv::Scalar sigma;
  cv::meanStdDev(gray, mean, sigma);
  return sigma[0];
}

double mean_change(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
}

TEST(BadFrame, FogLeavesTheContrastThatComesThrough) {
  for (const auto& [way_m, visibility_m] : {std::pair(120.0, 1000.0), std::pair(120.0, 240.0), std::pair(60.0, 60.0)}) {
    cv::Mat gray = ground();
    const double before = sigma_of(gray);
    add_fog(gray, way_m, visibility_m, Random(1));
    const double noise = 255 * kSensorNoise;
    EXPECT_NEAR(sigma_of(gray), std::hypot(std::pow(0.05, way_m / visibility_m) * before, noise), 0.5) << visibility_m;
  }
  cv::Mat clear = ground();
  add_fog(clear, 100, 1e6, Random(1));
  EXPECT_LT(mean_change(clear, ground()), 1.5);
}

TEST(BadFrame, CloudsHideTheShareOfTheFrame) {
  for (const double cover : {0.2, 0.5, 0.8}) {
    cv::Mat gray = ground();
    add_clouds(gray, cover, Random(3));
    // Half of what an edge covers counts as hidden: brighter than the ground ever is when more than that is cloud.
    const double hidden = cv::countNonZero(gray > 197) / static_cast<double>(gray.total());
    EXPECT_NEAR(hidden, cover, 0.06) << cover;
  }
  cv::Mat none = ground();
  add_clouds(none, 0, Random(3));
  EXPECT_EQ(mean_change(none, ground()), 0);
  cv::Mat all = ground();
  add_clouds(all, 1, Random(3));
  EXPECT_EQ(sigma_of(all), 0);
}

TEST(BadFrame, NoiseGrowsWithTheDark) {
  double before = 0;
  for (const double stops : {0.0, 2.0, 4.0, 6.0}) {
    cv::Mat gray(200, 200, CV_8UC1, cv::Scalar(100));
    take_in_the_dark(gray, stops, Random(5));
    const double electrons_per_gray = kFullWell_e / std::exp2(stops) / 255;
    const double expected = std::hypot(std::sqrt(100 * electrons_per_gray), kReadNoise_e) / electrons_per_gray;
    EXPECT_NEAR(sigma_of(gray), expected, 0.05 * expected + 0.1) << stops;
    EXPECT_GT(sigma_of(gray), before);
    before = sigma_of(gray);
  }
}

TEST(BadFrame, DropsBlurDiscs) {
  cv::Mat gray = ground();
  add_drops(gray, 0, Random(2));
  EXPECT_EQ(mean_change(gray, ground()), 0);
  double before = 0;
  for (const int drops : {5, 50, 500}) {
    cv::Mat wet = ground();
    add_drops(wet, drops, Random(2));
    const double share = cv::countNonZero(wet != ground()) / static_cast<double>(wet.total());
    EXPECT_GT(share, before);
    before = share;
  }
  EXPECT_GT(before, 0.5);
}

TEST(BadFrame, CompressionLosesMoreTheLowerTheQuality) {
  double before = 0;
  for (const int quality : {95, 50, 10, 2}) {
    cv::Mat gray = ground();
    compress(gray, quality);
    EXPECT_EQ(gray.size(), ground().size());
    EXPECT_EQ(gray.type(), CV_8UC1);
    const double change = mean_change(gray, ground());
    EXPECT_GT(change, before) << quality;
    before = change;
  }
}

TEST(BadFrame, IsTheSameForTheSameSeedAndAnotherForAnother) {
  const auto spoilt = [](std::uint64_t seed) {
    cv::Mat gray = ground();
    add_fog(gray, 100, 500, Random(seed));
    add_clouds(gray, 0.3, Random(seed));
    take_in_the_dark(gray, 3, Random(seed));
    add_drops(gray, 20, Random(seed));
    return gray;
  };
  EXPECT_EQ(mean_change(spoilt(1), spoilt(1)), 0);
  EXPECT_GT(mean_change(spoilt(1), spoilt(2)), 1);
}

}  // namespace
}  // namespace pilotage
