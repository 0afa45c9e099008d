// Frames of ground that the map does not show, where chance gives more support than on the ground from which the rate
// of false fixes was found.

#include <algorithm>
#include <cmath>

#include "match/shot.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;
using testing::make_textured_ground;
using testing::match_shot;
using testing::Shot;
using testing::ShotAnswer;
using testing::ShotMap;
using testing::TexturedGround;

constexpr int kTiles = 6;  // of 64 m
constexpr double kGsd_m = 0.5;

/// Fields of planted trees, all with the same rows; some trees are missing, and roads lie between the fields.
cv::Mat planted_rows(int side_px, Random& random) {
  cv::Mat gray(side_px, side_px, CV_8U, cv::Scalar(120));
  cv::randn(gray, cv::Scalar(120), cv::Scalar(4));
  constexpr int kShift = 8;
  const double row_px = 5 / kGsd_m;
  for (int top = 0; top < side_px;) {
    const int height = static_cast<int>(random.uniform(100, 200));
    for (int left = 0; left < side_px;) {
      const int width = static_cast<int>(random.uniform(100, 200));
      for (double y = top + row_px; y < std::min(top + height - 8, side_px); y += row_px) {
        for (double x = left + row_px; x < std::min(left + width - 8, side_px); x += row_px) {
          if (random.uniform(0, 1) < 0.03) continue;
          const Vector2d at = Vector2d(x, y) + 0.3 * Vector2d(random.normal(), random.normal());
          const Vector2d fixed = at * (1 << kShift);
          cv::circle(gray, {static_cast<int>(fixed.x()), static_cast<int>(fixed.y())},
                     static_cast<int>(random.uniform(3, 3.6) * (1 << kShift)), cv::Scalar(random.uniform(50, 75)),
                     cv::FILLED, cv::LINE_AA, kShift);
        }
      }
      left += width;
    }
    top += height;
  }
  cv::GaussianBlur(gray, gray, {0, 0}, 0.8);
  return gray;
}

TexturedGround planted_ground(std::uint64_t seed) {
  TexturedGround ground = make_textured_ground(kTiles);
  ground.camera = {320, 240, 140, 140, 160, 120};  // 137 m wide from 60 m
  const int side_px = static_cast<int>(ground.gray.width_px);
  Raster raster = ground.gray.read({0, 0, side_px, side_px});
  Random random(seed);
  raster.pixels = planted_rows(side_px, random);
  ground.gray = gray_source_from(raster);
  return ground;
}

Shot shot_of_any_heading(Random& random) {
  Shot shot;
  shot.east_m = random.uniform(-90, 90);
  shot.north_m = random.uniform(-90, 90);
  shot.attitude.yaw_deg = random.uniform(0, 360);
  shot.prior_off_m = {random.uniform(-10, 10), random.uniform(-10, 10)};
  return shot;
}

struct Counted {
  int right = 0;
  int false_fixes = 0;
};

/// Of frames of `shown`, against the map of `stored`.
Counted count_fixes(const ShotMap& stored, const TexturedGround& shown, int frames) {
  ShotMap other(shown);
  other.path = stored.path;
  MatchOptions options;
  options.chips = false;
  Random random(4);
  Counted counted;
  for (int i = 0; i < frames; ++i) {
    const ShotAnswer answer = match_shot(other, shot_of_any_heading(random), options);
    if (!answer.result.fix) continue;
    answer.center_error_m.norm() < 5 ? ++counted.right : ++counted.false_fixes;
  }
  return counted;
}

TEST(OtherGroundThorough, OfRowsThatAreTheSameEverywhereAFewAreTaken) {
  const ShotMap stored(planted_ground(1));
  Counted all;
  for (const std::uint64_t seed : {2, 3}) {
    const Counted counted = count_fixes(stored, planted_ground(seed), 100);
    all.false_fixes += counted.right + counted.false_fixes;
  }
  EXPECT_LE(all.false_fixes, 30) << "of 200; by rows that are the same everywhere the promised rate is not kept";
  const Counted own = count_fixes(stored, stored.ground, 40);
  EXPECT_EQ(own.false_fixes, 0);
  EXPECT_GE(own.right, 20) << "of 40";
}

TEST(OtherGround, AMapOfFewFeaturesIsBelievedNoMoreThanOneOfMany) {
  TexturedGround ground = make_textured_ground(kTiles);
  ground.camera = {320, 240, 140, 140, 160, 120};
  FeatureOptions few;
  few.features_per_mpx = 2000;
  const ShotMap stored(ground, few);
  TexturedGround mirrored = ground;
  const int side_px = static_cast<int>(ground.gray.width_px);
  Raster raster = ground.gray.read({0, 0, side_px, side_px});
  raster.pixels = raster.pixels.clone();  // it is the ground's own
  cv::flip(raster.pixels, raster.pixels, 0);
  mirrored.gray = gray_source_from(raster);
  const Counted other = count_fixes(stored, mirrored, 60);
  EXPECT_EQ(other.right + other.false_fixes, 0) << "of 60";
  const Counted own = count_fixes(stored, ground, 20);
  EXPECT_EQ(own.false_fixes, 0);
  EXPECT_GE(own.right, 15) << "of 20";
}

}  // namespace
}  // namespace pilotage
