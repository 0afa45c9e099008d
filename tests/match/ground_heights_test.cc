#include "pilotage/match/ground_heights.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using HeightAt = std::function<double(const Eigen::Vector2d&)>;

/// As features have them: 5 points for each cell of the lattice, anywhere within 640 × 480 px of (−100, 50).
GroundHeights scattered(const HeightAt& height_m, const std::function<bool(const Eigen::Vector2d&)>& known) {
  Random random(seed_from_name("scattered heights"));
  std::vector<Eigen::Vector2d> places_px;
  std::vector<double> heights_m;
  for (int i = 0; i < 6000; ++i) {
    places_px.emplace_back(random.uniform(-100, 540), random.uniform(50, 530));
    heights_m.push_back(known(places_px.back()) ? height_m(places_px.back()) : kNaN);
  }
  return {places_px, heights_m};
}

bool everywhere(const Eigen::Vector2d&) {
  return true;
}

TEST(GroundHeights, KnowNothingWithoutPoints) {
  EXPECT_FALSE(GroundHeights().known());
  EXPECT_TRUE(std::isnan(GroundHeights().height_m({0, 0})));
  const GroundHeights none({{1, 2}, {3, 4}}, {kNaN, kNaN});
  EXPECT_FALSE(none.known());
  EXPECT_TRUE(std::isnan(none.height_m({1, 2})));
}

TEST(GroundHeights, OfOnePointAreLevel) {
  const GroundHeights heights({{10, 20}}, {123.5});
  EXPECT_NEAR(heights.height_m({10, 20}), 123.5, 1e-3);
  EXPECT_NEAR(heights.height_m({-500, 900}), 123.5, 1e-3);
}

TEST(GroundHeights, OfAPlaneAreThePlane) {
  const auto plane = [](const Eigen::Vector2d& at) { return 300 + 0.3 * at.x() - 0.18 * at.y(); };
  const GroundHeights heights = scattered(plane, everywhere);
  for (const Eigen::Vector2d& at : {Eigen::Vector2d(0, 100), Eigen::Vector2d(333.3, 411), Eigen::Vector2d(-99, 529)}) {
    EXPECT_NEAR(heights.height_m(at), plane(at), 0.01) << at.transpose();
  }
}

TEST(GroundHeights, OfPointsOnALineAreThoseOfTheLine) {
  std::vector<Eigen::Vector2d> places_px;
  std::vector<double> heights_m;
  for (int i = 0; i < 100; ++i) {
    places_px.emplace_back(5 * i, 0);
    heights_m.push_back(0.5 * i);
  }
  EXPECT_NEAR(GroundHeights(places_px, heights_m).height_m({201, 0}), 20.1, 0.1);
}

TEST(GroundHeights, FollowHillsToAFractionOfTheirHeight) {
  // 10 m of relief over 150 px.
  const auto hills = [](const Eigen::Vector2d& at) {
    return 5 * std::sin(at.x() * 2 * M_PI / 300) * std::cos(at.y() * 2 * M_PI / 300);
  };
  const GroundHeights heights = scattered(hills, everywhere);
  for (double x = -60; x < 500; x += 37) {
    for (double y = 90; y < 490; y += 41) EXPECT_NEAR(heights.height_m({x, y}), hills({x, y}), 0.5) << x << " " << y;
  }
}

TEST(GroundHeights, GoOnOverAGapAndEndWhereThePointsEnd) {
  const auto slope = [](const Eigen::Vector2d& at) { return 0.2 * at.x(); };
  const auto beside_lake = [](const Eigen::Vector2d& at) { return (at - Eigen::Vector2d(220, 290)).norm() > 100; };
  const GroundHeights heights = scattered(slope, beside_lake);
  EXPECT_NEAR(heights.height_m({220, 290}), 44, 0.5);
  EXPECT_NEAR(heights.height_m({5000, 290}), heights.height_m({540, 290}), 0.1) << "a slope does not go on for ever";
}

}  // namespace
}  // namespace pilotage
