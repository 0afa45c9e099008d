#include "pilotage/landmark/outline.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;
using Outline = std::vector<Vector2d>;

Outline turned_rectangle(const Vector2d& center, double length, double width, double angle_rad) {
  const Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
  const Vector2d across(-along.y(), along.x());
  Outline outline;
  for (const auto& [a, b] : {std::pair{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}) {
    outline.push_back(center + along * (a * length / 2) + across * (b * width / 2));
  }
  return outline;
}

TEST(Outline, AreaDoesNotDependOnDirectionOrPlace) {
  const Outline square = turned_rectangle({594'000, 6'151'000}, 20, 20, 0.3);
  EXPECT_NEAR(outline_area(square), 400, 1e-6);
  EXPECT_NEAR(outline_area(Outline(square.rbegin(), square.rend())), 400, 1e-6);
  EXPECT_EQ(outline_area({{0, 0}, {1, 1}}), 0);
  EXPECT_EQ(outline_area({{0, 0}, {1, 1}, {2, 2}}), 0);
}

TEST(Outline, CirclesAreRoundAndSquaresAreNot) {
  EXPECT_GT(circularity(circle_outline({3, 4}, 30)), 0.99);
  EXPECT_NEAR(circularity(turned_rectangle({0, 0}, 10, 10, 0.7)), std::numbers::pi / 4, 1e-12);
  EXPECT_LT(circularity(turned_rectangle({0, 0}, 40, 10, 0)), 0.51);
  EXPECT_EQ(circularity({{1, 1}, {1, 1}, {1, 1}}), 0);
}

TEST(Outline, BoxOfARectangleIsTheRectangle) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const double angle = random.uniform(0, std::numbers::pi);
    const double width = random.uniform(2, 20);
    const double length = width + random.uniform(0.5, 30);
    const Vector2d center(random.uniform(-1e6, 1e6), random.uniform(-1e6, 1e6));
    const OrientedBox box = oriented_box(turned_rectangle(center, length, width, angle));
    EXPECT_NEAR(box.length, length, 1e-4);
    EXPECT_NEAR(box.width, width, 1e-4);
    EXPECT_NEAR((box.center - center).norm(), 0, 1e-4);
    const double off = std::remainder(box.angle_rad - angle, std::numbers::pi);
    EXPECT_NEAR(off, 0, 1e-4) << angle;
    EXPECT_GE(box.angle_rad, 0);
    EXPECT_LT(box.angle_rad, std::numbers::pi);
  }
}

TEST(Outline, BoxOfAnLIsTheSmallestAroundItsHull) {
  const OrientedBox box = oriented_box({{0, 0}, {30, 0}, {30, 10}, {10, 10}, {10, 20}, {0, 20}});
  EXPECT_NEAR(box.length, 30, 1e-4);
  EXPECT_NEAR(box.width, 20, 1e-4);
  EXPECT_NEAR(std::remainder(box.angle_rad, std::numbers::pi), 0, 1e-5);
  EXPECT_THROW(oriented_box({}), UsageError);
}

TEST(Outline, OverlapIsThatOfTheBoxesAndNotOfTheirBounds) {
  const auto box = [](const Vector2d& center, double length, double width, double angle_rad) {
    return oriented_box(turned_rectangle(center, length, width, angle_rad));
  };
  const OrientedBox one = box({0, 0}, 10, 10, 0);
  EXPECT_NEAR(overlap(one, one), 1, 1e-5);
  EXPECT_NEAR(overlap(one, box({5, 0}, 10, 10, 0)), 1.0 / 3, 1e-5);
  EXPECT_NEAR(overlap(one, box({10.001, 0}, 10, 10, 0)), 0, 1e-3);
  EXPECT_EQ(overlap(one, box({50, 0}, 10, 10, 0)), 0);
  // Two halls side by side: their bounds are nearly one.
  const Vector2d across(-std::sqrt(0.5), std::sqrt(0.5));
  EXPECT_EQ(overlap(box({6e5, 6e6}, 150, 10, std::numbers::pi / 4),
                    box(Vector2d(6e5, 6e6) + 12 * across, 150, 10, std::numbers::pi / 4)),
            0);
}

}  // namespace
}  // namespace pilotage
