#include "pilotage/simulate/spoilt_frame.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

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

double mean_of(const cv::Mat& gray) {
  return cv::mean(gray)[0];
}

double mean_change(const cv::Mat& a, const cv::Mat& b) {
  return cv::norm(a, b, cv::NORM_L1) / static_cast<double>(a.total());
}

TEST(SpoiltFrame, FogLeavesTheContrastThatComesThrough) {
  for (const auto& [way_m, visibility_m] : {std::pair(120.0, 1000.0), std::pair(120.0, 240.0), std::pair(60.0, 60.0)}) {
    cv::Mat gray = ground();
    const double through = std::pow(0.05, way_m / visibility_m);
    const double noise = 255 * kSensorNoise;
    const double rounding = std::sqrt(1.0 / 12);
    add_fog(gray, way_m, visibility_m, Random(1));
    EXPECT_NEAR(sigma_of(gray), std::hypot(through * sigma_of(ground()), noise, rounding), 0.1) << visibility_m;
    EXPECT_NEAR(mean_of(gray), through * mean_of(ground()) + (1 - through) * 200, 0.5) << visibility_m;
  }
  cv::Mat flat(200, 200, CV_8UC1, cv::Scalar(100));
  add_fog(flat, 100, 1e6, Random(1));
  EXPECT_NEAR(sigma_of(flat), std::hypot(255 * kSensorNoise, std::sqrt(1.0 / 12)), 0.05);
}

TEST(SpoiltFrame, CloudsHideTheShareOfTheFrame) {
  for (const double cover : {0.2, 0.5, 0.8}) {
    cv::Mat gray(240, 320, CV_8UC1, cv::Scalar(35));
    add_clouds(gray, cover, Random(3));
    const double half_hidden = cv::countNonZero(gray > (35 + 235) / 2) / static_cast<double>(gray.total());
    EXPECT_NEAR(half_hidden, cover, 0.01) << cover;
    const double in_between = cv::countNonZero((gray > 40) & (gray < 230)) / static_cast<double>(gray.total());
    EXPECT_GT(in_between, 0.01) << "edges are half transparent";
    EXPECT_LT(in_between, 0.2);
  }
  cv::Mat none = ground();
  add_clouds(none, 0, Random(3));
  EXPECT_EQ(mean_change(none, ground()), 0);
  cv::Mat all = ground();
  add_clouds(all, 1, Random(3));
  EXPECT_EQ(sigma_of(all), 0);
}

TEST(SpoiltFrame, NoiseGrowsWithTheDark) {
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

TEST(SpoiltFrame, DropsBlurDiscs) {
  cv::Mat dry = ground();
  add_drops(dry, 0, Random(2));
  EXPECT_EQ(mean_change(dry, ground()), 0);
  // Discs of 1 to 3 % of 320 px about uniform places leave exp(-n pi E[r^2] / area) dry, a little more along the
  // border.
  const double area_px2 = 320.0 * 240.0;
  const double mean_square_px2 = 320.0 * 320.0 * (0.03 * 0.03 * 0.03 - 0.01 * 0.01 * 0.01) / 3 / 0.02;
  for (const int drops : {20, 100, 400}) {
    cv::Mat wet = ground();
    add_drops(wet, drops, Random(2));
    const double share = cv::countNonZero(wet != ground()) / static_cast<double>(wet.total());
    EXPECT_NEAR(share, 1 - std::exp(-drops * std::numbers::pi * mean_square_px2 / area_px2), 0.08) << drops;
  }
  cv::Mat soaked = ground();
  add_drops(soaked, 20000, Random(2));
  EXPECT_LT(sigma_of(soaked), 0.2 * sigma_of(ground()));
  EXPECT_GT(mean_of(soaked), 1.1 * mean_of(ground()));
}

TEST(SpoiltFrame, CompressionLosesMoreTheLowerTheQuality) {
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

TEST(SpoiltFrame, EachIsTheSameForTheSameSeedAndAnotherForAnother) {
  const auto fog = [](cv::Mat& gray, Random random) { add_fog(gray, 100, 200, random); };
  const auto clouds = [](cv::Mat& gray, Random random) { add_clouds(gray, 0.5, random); };
  const auto dark = [](cv::Mat& gray, Random random) { take_in_the_dark(gray, 6, random); };
  const auto drops = [](cv::Mat& gray, Random random) { add_drops(gray, 50, random); };
  for (const std::function<void(cv::Mat&, Random)>& spoil :
       {std::function<void(cv::Mat&, Random)>(fog), {clouds}, {dark}, {drops}}) {
    const auto spoilt = [&](std::uint64_t seed) {
      cv::Mat gray = ground();
      spoil(gray, Random(seed));
      return gray;
    };
    EXPECT_EQ(mean_change(spoilt(1), spoilt(1)), 0);
    EXPECT_GT(mean_change(spoilt(1), spoilt(2)), 0.5);
  }
}

}  // namespace
}  // namespace pilotage
