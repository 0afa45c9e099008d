#include "pilotage/degradation/degradation_effects.h"

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/parallel.h"
#include "pilotage/degradation/degradation.h"
#include "pilotage/degradation/degradation_fields.h"

namespace pilotage {
namespace {

constexpr DegradationOptions kNothing{0, 0, 0, 3, 0, 0, 0, 0};

DegradationOptions everything() {
  DegradationOptions options;
  options.shadow = 0.5;
  options.haze = 0.3;
  options.water = 0.8;
  options.objects_per_mpx = 2000;
  options.object_size_px = 10;
  options.parallax_px = 3;
  return options;
}

/// Coarse structure and grain, 0 … 200 or so.
cv::Mat ground(int side) {
  cv::Mat coarse;
  const cv::Mat grain = white_field(side, Random(seed_from_name("effects")));
  cv::GaussianBlur(grain, coarse, {0, 0}, 6);
  return 100 + 300 * coarse + 4 * grain;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

double deviation(const cv::Mat& values, const cv::Mat& mask = {}) {
  cv::Scalar mean;
  cv::Scalar sigma;
  cv::meanStdDev(values, mean, sigma, mask.empty() ? cv::Mat(cv::Mat::ones(values.size(), CV_8U)) : mask);
  return sigma[0];
}

double correlation(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat result;
  cv::matchTemplate(a, b, result, cv::TM_CCOEFF_NORMED);
  return static_cast<double>(result.at<float>(0, 0));
}

/// The copy by the defaults and one effect at 0 whose other figures are far from theirs: the bytes of the defaults.
TEST(DegradationEffects, OffIsOffToTheByte) {
  const cv::Mat tile = ground(96);
  const cv::Mat plain = Degrader(64, 16, DegradationOptions{}, 5, 1).apply(tile);
  DegradationOptions options;
  options.shadow_share = 0.9;
  options.shadow_edge_px = 30;
  options.object_size_px = 60;
  options.parallax_scale_px = 50;
  EXPECT_TRUE(same(Degrader(64, 16, options, 5, 1).apply(tile), plain));
}

TEST(DegradationEffects, EachOneChangesTheCopy) {
  const cv::Mat tile = ground(96);
  const cv::Mat plain = Degrader(64, 16, kNothing, 5, 1).apply(tile);
  const DegradationOptions all = everything();
  for (const auto member : {&DegradationOptions::shadow, &DegradationOptions::haze, &DegradationOptions::water,
                            &DegradationOptions::objects_per_mpx, &DegradationOptions::parallax_px}) {
    DegradationOptions options = kNothing;
    options.object_size_px = 10;
    options.*member = all.*member;
    const cv::Mat copy = Degrader(64, 16, options, 5, 1).apply(tile);
    EXPECT_FALSE(same(copy, plain));
    EXPECT_TRUE(same(copy, Degrader(64, 16, options, 5, 1).apply(tile)));
    EXPECT_FALSE(same(copy, Degrader(64, 16, options, 6, 1).apply(tile)));
    EXPECT_FALSE(same(copy, Degrader(64, 16, options, 5, 2).apply(tile)));
  }
}

/// Each effect draws from its own stream, so switching one on changes the draws of no other.
TEST(DegradationEffects, DrawsDoNotDependOnOtherEffects) {
  const cv::Mat tile = ground(64);
  DegradationOptions options = kNothing;
  options.shadow = 0.5;
  options.shadow_edge_px = 0;
  const cv::Mat shadow = Degrader(64, 0, options, 9, 0).apply(tile);
  options.illumination = 0.3;
  const cv::Mat both = Degrader(64, 0, options, 9, 0).apply(tile);
  options.shadow = 0;
  const cv::Mat light = Degrader(64, 0, options, 9, 0).apply(tile);
  double low = 0;
  double high = 0;
  cv::minMaxLoc(tile, &low, &high);
  const cv::Mat plain = (tile - low) / (high - low);
  EXPECT_LT(cv::norm(both.mul(plain), shadow.mul(light), cv::NORM_INF), 1e-5);
}

TEST(DegradationEffects, SameBytesFromSeveralThreads) {
  const cv::Mat tile = ground(96);
  const Degrader degrader(64, 16, everything(), 3, 0);
  const cv::Mat alone = degrader.apply(tile);
  std::vector<cv::Mat> copies(24);
  parallel_for(copies.size(), 4, [&](std::size_t i, int) { copies[i] = degrader.apply(tile); });
  for (const cv::Mat& copy : copies) EXPECT_TRUE(same(copy, alone));
}

TEST(DegradationEffects, LevelAndContrastOfTheTileDoNotMatter) {
  const cv::Mat tile = ground(96);
  const Degrader degrader(64, 16, everything(), 3, 0);
  EXPECT_GT(correlation(degrader.apply(tile), degrader.apply(tile * 257 - 30000)), 0.9999);
}

TEST(DegradationEffects, FlatStaysFlat) {
  const cv::Mat copy = Degrader(32, 0, everything(), 1, 0).apply(cv::Mat(32, 32, CV_32F, cv::Scalar(7)));
  EXPECT_LT(cv::norm(copy - cv::mean(copy)[0], cv::NORM_INF), 1e-6);
}

/// With slope 1 every octave has the power of the next finer one, with 0 a quarter of it.
TEST(DegradationEffects, TextureFallsWithFrequencyAsStated) {
  for (const double slope : {0.0, 0.5, 1.0}) {
    const cv::Mat field = texture_field(256, 64, slope, Random(seed_from_name("slope")));
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
    EXPECT_NEAR(std::log2(power(64, 128) / power(32, 64)), 2 - 2 * slope, 0.15) << slope;
    EXPECT_NEAR(std::log2(power(32, 64) / power(16, 32)), 2 - 2 * slope, 0.2) << slope;
  }
}

TEST(DegradationEffects, ShadowsHaveTheStatedContrastShareAndEdge) {
  for (const double share : {0.05, 0.2, 0.5}) {
    const std::string what = "share " + std::to_string(share);
    const cv::Mat hard = shadow_field(200, 0.6, share, 0, Random(seed_from_name(what)));
    const double dark = cv::countNonZero(cv::abs(hard - 0.4) < 1e-6) / 4e4;
    EXPECT_EQ(cv::countNonZero(cv::abs(hard - 0.4) < 1e-6) + cv::countNonZero(hard == 1), 40000) << what;
    EXPECT_GE(dark, share) << what;
    EXPECT_LE(dark, share + 1.0 / 16) << what;
    const cv::Mat soft = shadow_field(200, 0.6, share, 2, Random(seed_from_name(what)));
    EXPECT_NEAR(cv::mean(soft)[0], cv::mean(hard)[0], 0.01) << what;
    // Along rows no step of a Gaussian edge is higher than contrast/(sigma·sqrt(2π)).
    const cv::Mat steps = cv::abs(soft.colRange(1, 200) - soft.colRange(0, 199));
    double highest = 0;
    cv::minMaxLoc(steps, nullptr, &highest);
    EXPECT_LT(highest, 1.05 * 0.6 / (2 * std::sqrt(2 * CV_PI))) << what;
    EXPECT_GT(highest, 0.3 * 0.6 / (2 * std::sqrt(2 * CV_PI))) << what;
  }
}

/// A chessboard of 0 and 1: haze brings both nearer to 1, by a share that varies slowly about the stated one.
TEST(DegradationEffects, HazeTakesContrastAndAddsItsLight) {
  cv::Mat board(128, 128, CV_32F);
  for (int row = 0; row < 128; ++row) {
    for (int col = 0; col < 128; ++col) board.at<float>(row, col) = static_cast<float>((row + col) % 2);
  }
  DegradationOptions options = kNothing;
  options.haze = 0.4;
  double mean_lost = 0;
  for (int copy = 0; copy < 32; ++copy) {
    const cv::Mat hazy = Degrader(128, 0, options, 1, copy).apply(board);
    EXPECT_LT(cv::norm(hazy - 1, cv::NORM_INF), 1);  // no darkness is left
    cv::Mat lost;                                    // in the dark fields what is seen is the haze
    hazy.copyTo(lost, board == 0);
    double most = 0;
    cv::minMaxLoc(lost, nullptr, &most);
    EXPECT_LE(most, 0.6 + 1e-5);
    double least = 0;
    cv::minMaxLoc(hazy, &least, nullptr, nullptr, nullptr, board == 0);
    EXPECT_GE(least, 0.2 - 1e-5);
    EXPECT_LT(cv::norm(hazy - 1, cv::NORM_INF, board == 1), 1e-6);  // as bright as the brightest ground
    mean_lost += 2 * cv::mean(lost)[0] / 32;
  }
  EXPECT_NEAR(mean_lost, 0.4, 0.05);
}

TEST(DegradationEffects, NoiseDoesNotFadeInHaze) {
  DegradationOptions options = kNothing;
  options.noise = 0.5;
  const cv::Mat tile = ground(128);
  DegradationOptions hazy = options;
  hazy.haze = 0.5;
  DegradationOptions silent = hazy;
  silent.noise = 0;
  double low = 0;
  double high = 0;
  cv::minMaxLoc(tile, &low, &high);
  const cv::Mat scaled = (tile - low) / (high - low);
  const double in_clear = deviation(Degrader(128, 0, options, 1, 0).apply(tile) - tile) / (high - low);
  const double in_haze =
      deviation(Degrader(128, 0, hazy, 1, 0).apply(tile) - Degrader(128, 0, silent, 1, 0).apply(tile));
  EXPECT_NEAR(in_haze / in_clear, 1, 1e-3);
  EXPECT_NEAR(in_clear / deviation(scaled), 0.5, 0.01);
}

/// A dark lake with faint ripples on the left, bright rough land on the right.
cv::Mat shore() {
  cv::Mat picture = ground(128);
  const cv::Mat ripples = white_field(128, Random(seed_from_name("shore")));
  cv::Mat lake = picture.colRange(0, 64);
  cv::Mat(10 + ripples.colRange(0, 64)).copyTo(lake);
  return picture;
}

TEST(DegradationEffects, WaterIsWhatIsFlatAndDark) {
  const cv::Mat picture = shore();
  const cv::Mat mask = water_mask(picture);
  EXPECT_GT(cv::mean(mask.colRange(0, 50))[0], 0.99);
  EXPECT_EQ(cv::countNonZero(mask.colRange(76, 128)), 0);
  EXPECT_EQ(cv::countNonZero(water_mask(300 - picture).colRange(0, 50)), 0);  // bright and flat: a roof, sand
  EXPECT_EQ(cv::countNonZero(water_mask(cv::Mat::ones(16, 16, CV_32F))), 0);
}

TEST(DegradationEffects, WaterIsDrawnAnewAndTheLandStays) {
  const cv::Mat picture = shore();
  DegradationOptions options = kNothing;
  options.water = 1;
  const cv::Mat copy = Degrader(128, 0, options, 1, 0).apply(picture);
  EXPECT_TRUE(same(copy.colRange(76, 128), picture.colRange(76, 128)));
  const cv::Rect lake(4, 4, 44, 120);
  EXPECT_LT(std::abs(correlation(copy(lake), picture(lake))), 0.15);
  EXPECT_NEAR(deviation(copy(lake)) / deviation(picture(lake)), 1, 0.25);
  EXPECT_NEAR(cv::mean(copy(lake))[0], cv::mean(picture(lake))[0], 0.5);
  options.water = 0.6;
  const cv::Mat partly = Degrader(128, 0, options, 1, 0).apply(picture);
  EXPECT_NEAR(correlation(partly(lake), picture(lake)), 0.8, 0.1);  // sqrt(1 − 0.36)
}

TEST(DegradationEffects, ObjectsAreAsManyAndAsLargeAsStated) {
  double count = 0;
  double area = 0;
  constexpr int kDraws = 200;
  for (int draw = 0; draw < kDraws; ++draw) {
    for (const MovedObject& object : draw_objects(250, 200, 20, Random(static_cast<std::uint64_t>(draw)))) {
      ++count;
      area += cv::sum(object.weight)[0];
      const cv::Rect from(object.from, object.to.size());
      EXPECT_EQ((object.to & cv::Rect(0, 0, 250, 250)), object.to);
      EXPECT_EQ((from & cv::Rect(0, 0, 250, 250)), from);
      EXPECT_LE(cv::norm(object.from - object.to.tl()), 80 * 1.5);
    }
  }
  // 12.5 a picture; a twentieth or so is lost beyond the border.
  EXPECT_NEAR(count / kDraws, 12.5, 0.3);
  EXPECT_NEAR(area / count, 400, 40);
}

TEST(DegradationEffects, ObjectsShowOtherGroundAndNothingElseChanges) {
  const cv::Mat picture = ground(128);
  const auto objects = draw_objects(128, 300, 16, Random(seed_from_name("objects")));
  ASSERT_GE(objects.size(), 3U);
  cv::Mat copy = picture.clone();
  move_objects(objects, copy);
  cv::Mat untouched = cv::Mat::ones(128, 128, CV_8U);
  for (const MovedObject& object : objects) untouched(object.to).setTo(0, object.weight > 0);
  EXPECT_EQ(cv::norm(copy, picture, cv::NORM_INF, untouched), 0);
  const MovedObject& last = objects.back();  // nothing lies on it
  const cv::Mat shown = picture(cv::Rect(last.from, last.to.size()));
  EXPECT_LT(cv::norm(copy(last.to), shown, cv::NORM_INF, last.weight == 1), 1e-4);
  EXPECT_GT(cv::norm(picture(last.to), shown, cv::NORM_INF, last.weight == 1), 10);
}

cv::Point2d centroid_of_bright(const cv::Mat& picture, const cv::Rect& within) {
  const cv::Moments moments = cv::moments(picture(within) > 150, true);
  return {within.x + moments.m10 / moments.m00, within.y + moments.m01 / moments.m00};
}

/// A bright roof on even ground stands aside by about parallax_px; the ground far from it stays.
TEST(DegradationEffects, TallThingsMoveAndTheGroundStays) {
  cv::Mat tile = 50 + 2 * white_field(128 + 16, Random(seed_from_name("roof")));
  cv::rectangle(tile, cv::Rect(54, 54, 36, 36), 250, cv::FILLED);
  DegradationOptions options = kNothing;
  options.parallax_px = 4;
  ASSERT_LE(rotation_margin_px(128, options), 8);
  const cv::Mat before = Degrader(128, 8, kNothing, 1, 0).apply(tile);
  const cv::Mat copy = Degrader(128, 8, options, 1, 0).apply(tile);
  const cv::Rect around(20, 20, 88, 88);
  const cv::Point2d moved = centroid_of_bright(copy, around) - centroid_of_bright(before, around);
  EXPECT_GT(cv::norm(moved), 2);
  EXPECT_LT(cv::norm(moved), 4.1);
  EXPECT_TRUE(cv::norm(copy(cv::Rect(0, 0, 128, 12)), before(cv::Rect(0, 0, 128, 12)), cv::NORM_INF) < 2);
}

TEST(DegradationEffects, EvenGroundHasNoHeight) {
  const cv::Mat heights = guess_heights(100 + white_field(256, Random(seed_from_name("even"))), 6);
  EXPECT_LT(cv::mean(heights)[0], 0.1);
  double highest = 0;
  cv::minMaxLoc(heights, nullptr, &highest);
  EXPECT_LT(highest, 0.3);
}

TEST(DegradationEffects, MarginHoldsTheParallax) {
  DegradationOptions options = kNothing;
  options.parallax_px = 2.5;
  EXPECT_EQ(rotation_margin_px(64, options), 4);
  options.rotation_deg = 5;
  options.scale_percent = 3;
  const int with = rotation_margin_px(64, options);
  options.parallax_px = 0;
  EXPECT_GE(with - rotation_margin_px(64, options), 2);
}

}  // namespace
}  // namespace pilotage
