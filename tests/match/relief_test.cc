#include "pilotage/match/relief.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/match/local_map.h"

namespace pilotage {
namespace {

/// Features anywhere within ± 300 px of `center_px`, with heights.
LocalMap map_of(const std::function<double(const Eigen::Vector2d&)>& height_m,
                const Eigen::Vector2d& center_px = {0, 0}) {
  Random random(seed_from_name("relief"));
  LocalMap map;
  for (int i = 0; i < 4000; ++i) {
    const Eigen::Vector2d at(center_px.x() + random.uniform(-300, 300), center_px.y() + random.uniform(-300, 300));
    map.features.features.push_back({static_cast<float>(at.x()), static_cast<float>(at.y())});
    map.ground_height_m.push_back(static_cast<float>(height_m(at)));
  }
  return map;
}

constexpr double kAgl_m = 120;

TEST(ReliefOf, DoesNothingWhereNoHeightIsKnown) {
  LocalMap map = map_of([](const Eigen::Vector2d&) { return kNaN; });
  map.relief = relief_of(map, {}, {}, {{0, 0}, 20, kAgl_m});
  EXPECT_FALSE(map.relief.ground.known());
  EXPECT_TRUE(map.relief.stretch.empty());
  EXPECT_EQ(map.relief.scale_sigma, 0);
  EXPECT_EQ(map.stretch_of(17), 1);
}

TEST(ReliefOf, StretchesWhatLiesBelowTheNadirAndShrinksWhatLiesAbove) {
  LocalMap map = map_of([](const Eigen::Vector2d& at) { return 50 + 0.1 * at.x(); });
  map.relief = relief_of(map, {}, {}, {{100, 0}, 20, kAgl_m});
  for (std::size_t i = 0; i < map.features.size(); ++i) {
    const double rise_m = 0.1 * (static_cast<double>(map.features.features[i].x_px) - 100);
    EXPECT_NEAR(map.stretch_of(i), 1 - rise_m / kAgl_m, 1e-3);
  }
}

TEST(ReliefOf, LevelGroundLeavesTheScaleToTheAltimeter) {
  LocalMap map = map_of([](const Eigen::Vector2d&) { return 50; });
  map.relief = relief_of(map, {}, {}, {{0, 0}, 200, kAgl_m});
  EXPECT_NEAR(map.relief.scale_sigma, 0, 1e-5);
}

TEST(ReliefOf, TheScaleIsAsUnsureAsTheHeightWhereTheAircraftMayBe) {
  LocalMap map = map_of([](const Eigen::Vector2d& at) { return 0.2 * at.x(); });
  map.relief = relief_of(map, {}, {}, {{0, 0}, 30, kAgl_m});
  EXPECT_NEAR(map.relief.scale_sigma, 0.2 * 30 / kAgl_m, 0.1 * 0.2 * 30 / kAgl_m);
}

TEST(ReliefOf, NoScaleIsSearchedThatNoPlacementMayHave) {
  LocalMap map = map_of([](const Eigen::Vector2d& at) { return 2 * at.x(); });
  map.relief = relief_of(map, {}, {}, {{0, 0}, 100, kAgl_m});
  EXPECT_EQ(map.relief.scale_sigma, 0.25) << "two of them are half the scale";
}

TEST(ReliefOf, AFeatureWithoutAHeightHasThatOfTheGroundAround) {
  LocalMap map = map_of([](const Eigen::Vector2d& at) { return at.x() > 0 && at.x() < 15 ? kNaN : 0.2 * at.x(); });
  map.relief = relief_of(map, {}, {}, {{-100, 0}, 20, kAgl_m});
  for (std::size_t i = 0; i < map.features.size(); ++i) {
    if (std::isfinite(map.ground_height_m[i])) continue;
    const double rise_m = 0.2 * (static_cast<double>(map.features.features[i].x_px) + 100);
    EXPECT_NEAR(map.stretch_of(i), 1 - rise_m / kAgl_m, 0.01);
  }
}

TEST(ReliefOf, TheGroundBelowCountsWhereTheWindowDoesNotShowIt) {
  const auto step = [](const Eigen::Vector2d& at) { return at.x() > 700 ? 30.0 : 0.0; };
  LocalMap ahead = map_of(step, {1200, 0});
  LocalMap below = map_of(step, {0, 0});
  for (Feature& feature : below.features.features) feature.x_px += 50;  // of another reference
  below.reference_px = {-50, 0};
  ahead.relief = relief_of(ahead, below, {}, {{0, 0}, 20, kAgl_m});
  EXPECT_NEAR(ahead.relief.ground.height_m({0, 0}), 0, 1);
  EXPECT_NEAR(ahead.stretch_of(0), 0.75, 0.01);
}

TEST(ReliefOf, LandmarksSayHowHighTheGroundIsWhereNoFeatureDoes) {
  LocalMap none;
  const std::vector<SpotHeight> landmarks{{{0, 0}, 50}, {{1000, 0}, 90}, {{0, 1000}, 50}, {{500, 500}, kNaN}};
  none.relief = relief_of(none, {}, landmarks, {{0, 0}, 20, kAgl_m});
  ASSERT_TRUE(none.relief.ground.known());
  EXPECT_TRUE(none.relief.is_sparse);
  EXPECT_NEAR(none.relief.below_m, 50, 1);
  EXPECT_NEAR(none.relief.ground.height_m({500, 0}), 70, 3) << "between them as a plane";
  EXPECT_NEAR(none.relief.stretch_at({1000, 0}), 1 - 40 / kAgl_m, 0.01);
  EXPECT_GT(none.relief.scale_sigma, 0);
}

TEST(ReliefOf, LandmarksInARowSayNothingOfWhatLiesBeside) {
  LocalMap none;
  const std::vector<SpotHeight> landmarks{{{0, 0}, 50}, {{203, 200}, 58}, {{400, 400}, 50}};
  none.relief = relief_of(none, {}, landmarks, {{200, 200}, 20, kAgl_m});
  for (const Eigen::Vector2d& corner : {Eigen::Vector2d(0, 400), Eigen::Vector2d(400, 0)}) {
    EXPECT_NEAR(none.relief.ground.height_m(corner), 53, 6);
  }
}

TEST(ReliefOf, LandmarksSayNothingWhereFeaturesDo) {
  LocalMap map = map_of([](const Eigen::Vector2d&) { return 50; });
  map.relief = relief_of(map, {}, {{{0, 0}, 90}}, {{0, 0}, 20, kAgl_m});
  EXPECT_FALSE(map.relief.is_sparse);
  EXPECT_NEAR(map.relief.below_m, 50, 0.01);
}

TEST(ReliefOf, GroundAsHighAsTheCameraStaysInBounds) {
  LocalMap map = map_of([](const Eigen::Vector2d& at) { return 2 * at.x(); });
  map.relief = relief_of(map, {}, {}, {{0, 0}, 20, kAgl_m});
  for (std::size_t i = 0; i < map.features.size(); ++i) {
    EXPECT_GE(map.stretch_of(i), 0.29);
    EXPECT_LE(map.stretch_of(i), 3);
  }
}

/// Ground at 0.5 m per pixel with a picture on it, and the frame of it that level ground at kAgl_m would make.
double gray_at(const Eigen::Vector2d& place_px) {
  return 128 + 60 * std::sin(place_px.x() / 9) + 50 * std::cos(place_px.y() / 7);
}

TEST(LaidOverRelief, ShowsTheGroundWhereItIs) {
  LocalMap map = map_of([](const Eigen::Vector2d& at) { return 10 * std::sin(at.x() / 60); });
  map.relief = relief_of(map, {}, {}, {{0, 0}, 20, kAgl_m});
  const Eigen::Vector2d nadir_px(40, -30);
  for (const double px_per_pixel : {1.0, 2.0}) {
    RectifiedFrame level;
    level.status = RectifyStatus::kOk;
    level.gsd_m = 0.5 * px_per_pixel;
    level.origin_m = {-60, 45};
    level.gray = cv::Mat(static_cast<int>(180 / px_per_pixel), static_cast<int>(240 / px_per_pixel), CV_8U);
    level.valid = cv::Mat(level.gray.size(), CV_8U, cv::Scalar(255));
    for (int row = 0; row < level.gray.rows; ++row) {
      for (int col = 0; col < level.gray.cols; ++col) {
        // A ray meets the ground at the stretch of its height there.
        const Eigen::Vector2d off =
            px_per_pixel * (Eigen::Vector2d(col + 0.5, row + 0.5) - level.pixel_from_ground({0, 0}));
        Eigen::Vector2d met = off;
        for (int i = 0; i < 20; ++i) met = map.relief.stretch_at(nadir_px + met) * off;
        level.gray.at<std::uint8_t>(row, col) = cv::saturate_cast<std::uint8_t>(gray_at(nadir_px + met));
      }
    }
    const RectifiedFrame laid = laid_over_relief(level, map.relief, nadir_px, px_per_pixel);
    double sum = 0;
    double sum_level = 0;
    int count = 0;
    for (int row = 12; row < level.gray.rows - 12; ++row) {
      for (int col = 12; col < level.gray.cols - 12; ++col) {
        if (laid.valid.at<std::uint8_t>(row, col) == 0) continue;
        const Eigen::Vector2d off =
            px_per_pixel * (Eigen::Vector2d(col + 0.5, row + 0.5) - level.pixel_from_ground({0, 0}));
        sum += std::abs(laid.gray.at<std::uint8_t>(row, col) - gray_at(nadir_px + off));
        sum_level += std::abs(level.gray.at<std::uint8_t>(row, col) - gray_at(nadir_px + off));
        ++count;
      }
    }
    ASSERT_GT(count, 0.5 * static_cast<double>(level.gray.total()));
    EXPECT_LT(sum / count, 3) << px_per_pixel;
    EXPECT_GT(sum_level, 4 * sum) << px_per_pixel << ": the frame as it was";
  }
}

TEST(LaidOverRelief, IsTheFrameItselfWhereNoHeightIsKnown) {
  RectifiedFrame level;
  level.gray = cv::Mat(20, 30, CV_8U, cv::Scalar(7));
  level.valid = cv::Mat(20, 30, CV_8U, cv::Scalar(255));
  level.gsd_m = 1;
  EXPECT_EQ(laid_over_relief(level, {}, {5, 5}, 1).gray.data, level.gray.data);
}

}  // namespace
}  // namespace pilotage
