#include "pilotage/degradation/degradation.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"
#include "pilotage/degradation/degradation_fields.h"

namespace pilotage {
namespace {

constexpr DegradationOptions kNothing{0, 0, 0, 3, 0, 0, 0, 0};

/// Coarse structure and grain.
cv::Mat ground(int side, double grain) {
  Random random(seed_from_name("degradation"));
  cv::Mat image(side, side, CV_32F);
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) image.at<float>(row, col) = static_cast<float>(random.normal());
  }
  cv::Mat coarse;
  cv::GaussianBlur(image, coarse, {0, 0}, 8);
  return 100 + 300 * coarse + grain * image;
}

double correlation(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat result;
  cv::matchTemplate(a, b, result, cv::TM_CCOEFF_NORMED);
  return static_cast<double>(result.at<float>(0, 0));
}

TEST(Degradation, EverythingOffIsTheTile) {
  const cv::Mat tile = ground(64, 5);
  EXPECT_EQ(cv::norm(Degrader(64, 0, kNothing, 1, 0).apply(tile), tile, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(Degrader(60, 2, kNothing, 1, 0).apply(tile), tile(cv::Rect(2, 2, 60, 60)), cv::NORM_INF), 0);
  EXPECT_EQ(rotation_margin_px(64, kNothing), 0);
}

TEST(Degradation, SameSeedSameCopyOtherSeedAnother) {
  const cv::Mat tile = ground(80, 5);
  const DegradationOptions options;
  const cv::Mat first = Degrader(64, 8, options, 7, 0).apply(tile);
  EXPECT_EQ(cv::norm(first, Degrader(64, 8, options, 7, 0).apply(tile), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(first, Degrader(64, 8, options, 8, 0).apply(tile), cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(first, Degrader(64, 8, options, 7, 1).apply(tile), cv::NORM_INF), 0);
}

TEST(Degradation, SameBytesFromSeveralThreads) {
  const cv::Mat tile = ground(96, 5);
  const Degrader degrader(64, 16, DegradationOptions{}, 3, 0);
  const cv::Mat alone = degrader.apply(tile);
  std::vector<cv::Mat> copies(24);
  parallel_for(copies.size(), 4, [&](std::size_t i, int) { copies[i] = degrader.apply(tile); });
  for (const cv::Mat& copy : copies) EXPECT_EQ(cv::norm(copy, alone, cv::NORM_INF), 0);
}

double deviation(const cv::Mat& values) {
  cv::Scalar mean;
  cv::Scalar sigma;
  cv::meanStdDev(values, mean, sigma);
  return sigma[0];
}

/// Each effect draws from its own stream: the noise is the same with new texture and without.
TEST(Degradation, DrawsDoNotDependOnOtherEffects) {
  const cv::Mat tile = ground(64, 5);
  DegradationOptions options = kNothing;
  options.noise = 0.5;
  const cv::Mat noise = (Degrader(64, 0, options, 9, 0).apply(tile) - tile) / deviation(tile);
  EXPECT_NEAR(deviation(noise), 0.5, 0.02);
  options.texture_redrawn = 0.65;
  const cv::Mat both = Degrader(64, 0, options, 9, 0).apply(tile);
  options.noise = 0;
  const cv::Mat texture = Degrader(64, 0, options, 9, 0).apply(tile);
  EXPECT_LT(cv::norm((both - texture) / deviation(texture), noise, cv::NORM_INF), 1e-5);
}

/// New texture is white: every octave of frequency has a quarter of the power of the next finer one.
TEST(Degradation, TextureIsWhite) {
  const cv::Mat field = texture_field(256, 64, Random(seed_from_name("slope")));
  EXPECT_NEAR(deviation(field), 1, 1e-3);
  cv::Mat spectrum;
  cv::dft(field, spectrum, cv::DFT_COMPLEX_OUTPUT);
  const auto power = [&](double low, double high) {  // of frequencies in cycles per picture
    double sum = 0;
    for (int row = 0; row < 256; ++row) {
      for (int col = 0; col < 256; ++col) {
        const double frequency = std::hypot(std::min(row, 256 - row), std::min(col, 256 - col));
        const cv::Vec2f value = spectrum.at<cv::Vec2f>(row, col);
        if (frequency >= low && frequency < high) sum += static_cast<double>(value.dot(value));
      }
    }
    return sum;
  };
  EXPECT_NEAR(std::log2(power(64, 128) / power(32, 64)), 2, 0.15);
  EXPECT_NEAR(std::log2(power(32, 64) / power(16, 32)), 2, 0.2);
}

TEST(Degradation, RotationTurnsAboutTheCentre) {
  DegradationOptions options = kNothing;
  options.rotation_deg = 10;
  const int margin = rotation_margin_px(65, options);
  cv::Mat tile = cv::Mat::zeros(65 + 2 * margin, 65 + 2 * margin, CV_32F);
  cv::circle(tile, {margin + 32, margin + 32}, 3, 1, cv::FILLED);
  cv::circle(tile, {margin + 57, margin + 32}, 3, 1, cv::FILLED);  // 25 px to the right
  const cv::Mat copy = Degrader(65, margin, options, 1, 0).apply(tile);
  EXPECT_GT(copy.at<float>(32, 32), 0.9F);
  const double angle = 10 * CV_PI / 180;  // copy(x) = tile(R x): what lay at 0° now lies at −10°
  const cv::Point there(static_cast<int>(std::lround(32 + 25 * std::cos(angle))),
                        static_cast<int>(std::lround(32 - 25 * std::sin(angle))));
  EXPECT_GT(copy.at<float>(there), 0.9F);
  EXPECT_LT(Degrader(65, margin, options, 1, 1).apply(tile).at<float>(there), 0.1F);  // the other way round
}

TEST(Degradation, MarginHoldsTheTurnedTile) {
  DegradationOptions options = kNothing;
  options.rotation_deg = 5;
  options.scale_percent = 4;
  const int margin = rotation_margin_px(100, options);
  // Corner of the copy in the tile: half the diagonal, turned and stretched.
  const double angle = (45 + 5) * CV_PI / 180;
  EXPECT_GE(margin, 50 * std::sqrt(2.0) * 1.04 * std::sin(angle) - 50);
  EXPECT_LE(margin, 50 * std::sqrt(2.0) * 1.04 * std::sin(angle) - 50 + 3);
}

TEST(Degradation, TextureGoesCoarseStructureStays) {
  DegradationOptions options = kNothing;
  options.texture_redrawn = 1;
  const cv::Mat tile = ground(128, 12);
  const cv::Mat copy = Degrader(128, 0, options, 3, 0).apply(tile);
  cv::Mat tile_coarse;
  cv::Mat copy_coarse;
  cv::GaussianBlur(tile, tile_coarse, {0, 0}, 6);
  cv::GaussianBlur(copy, copy_coarse, {0, 0}, 6);
  EXPECT_GT(correlation(tile_coarse, copy_coarse), 0.98);
  EXPECT_LT(std::abs(correlation(tile - tile_coarse, copy - copy_coarse)), 0.2);
  // The new texture is about as strong as the old one.
  EXPECT_NEAR(cv::norm(copy - copy_coarse) / cv::norm(tile - tile_coarse), 1, 0.15);
}

TEST(Degradation, StrongerEffectsCorrelateLess) {
  const cv::Mat tile = ground(128, 12);
  const auto peak = [&](auto DegradationOptions::*member, double value) {
    DegradationOptions options = kNothing;
    options.*member = value;
    const int margin = rotation_margin_px(100, options);
    return correlation(Degrader(100, margin, options, 5, 0)
                           .apply(tile(cv::Rect(14 - margin, 14 - margin, 100 + 2 * margin, 100 + 2 * margin))),
                       tile(cv::Rect(14, 14, 100, 100)));
  };
  EXPECT_GT(peak(&DegradationOptions::rotation_deg, 1), peak(&DegradationOptions::rotation_deg, 4));
  EXPECT_GT(peak(&DegradationOptions::scale_percent, 1), peak(&DegradationOptions::scale_percent, 6));
  EXPECT_GT(peak(&DegradationOptions::texture_redrawn, 0.3), peak(&DegradationOptions::texture_redrawn, 0.9));
  EXPECT_GT(peak(&DegradationOptions::illumination, 0.1), peak(&DegradationOptions::illumination, 0.6));
  EXPECT_GT(peak(&DegradationOptions::gamma, 0.1), peak(&DegradationOptions::gamma, 1));
  EXPECT_GT(peak(&DegradationOptions::blur_px, 0.5), peak(&DegradationOptions::blur_px, 4));
  EXPECT_GT(peak(&DegradationOptions::noise, 0.1), peak(&DegradationOptions::noise, 1));
}

/// A repeated field of the same options must not depend on the tile's level: reflectance in 8 or 16 bits, or centred.
TEST(Degradation, LevelAndContrastOfTheTileDoNotMatter) {
  const cv::Mat tile = ground(96, 6);
  const Degrader degrader(80, 8, DegradationOptions{}, 11, 2);
  const cv::Mat copy = degrader.apply(tile);
  const cv::Mat shifted = degrader.apply(tile * 257 - 30000);
  EXPECT_GT(correlation(copy, shifted), 0.9999);
}

TEST(Degradation, FlatStaysFlat) {
  const cv::Mat copy = Degrader(32, 0, DegradationOptions{}, 1, 0).apply(cv::Mat(32, 32, CV_32F, cv::Scalar(7)));
  EXPECT_LT(cv::norm(copy - cv::mean(copy)[0], cv::NORM_INF), 1e-6);
}

TEST(Degradation, RefusesWhatItCannotDo) {
  DegradationOptions options;
  options.noise = -1;
  EXPECT_THROW(Degrader(32, 0, options, 1, 0), UsageError);
  EXPECT_THROW(Degrader(0, 0, DegradationOptions{}, 1, 0), UsageError);
  EXPECT_THROW(Degrader(32, 0, DegradationOptions{}, 1, 0).apply(cv::Mat(32, 32, CV_8U)), UsageError);
  EXPECT_THROW(Degrader(32, 4, DegradationOptions{}, 1, 0).apply(cv::Mat(32, 32, CV_32F)), UsageError);
}

}  // namespace
}  // namespace pilotage
