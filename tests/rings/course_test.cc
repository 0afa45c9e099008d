#include "course.h"

#include <gtest/gtest.h>

namespace pilotage {
namespace {

constexpr double kHalfSpan_m = 0.35;

/// Straight on at 2 m/s, a point each 2 cm.
std::vector<PathPoint> straight(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double start_s = 0) {
  std::vector<PathPoint> path;
  const int points = static_cast<int>((to - from).norm() / 0.02);
  for (int i = 0; i <= points; ++i) path.push_back({start_s + 0.01 * i, from + (to - from) * i / points, {}, {}});
  return path;
}

const Ring kRing{0, {0, 10, 6}, 90, 0};  // faces east, inner radius 1.2 m

TEST(Judge, OffsetClearanceAndAngleAreThoseOfThePath) {
  const CourseOutcome outcome = judge({{kRing}, {}}, straight({-5, 10.3, 6.4}, {5, 10.3, 6.4}), kHalfSpan_m);
  const Crossing& crossing = outcome.crossings[0];
  EXPECT_NEAR(crossing.offset_m.value(), 0.5, 1e-9);
  EXPECT_NEAR(crossing.clearance_m, 1.2 - 0.35 - 0.5, 1e-9);
  EXPECT_NEAR(crossing.angle_deg, 0, 1e-4);
  EXPECT_NEAR(crossing.time_s, 2.5, 1e-6);
  EXPECT_TRUE(crossing.crossed());
  EXPECT_TRUE(outcome.in_order);
  EXPECT_EQ(outcome.collisions, 0);
}

TEST(Judge, ARingThatIsTouchedIsNotCrossed) {
  const CourseOutcome outcome = judge({{kRing}, {}}, straight({-5, 11, 6}, {5, 11, 6}), kHalfSpan_m);
  EXPECT_TRUE(outcome.crossings[0].pierced);
  EXPECT_TRUE(outcome.crossings[0].collided);
  EXPECT_EQ(outcome.crossed, 0);
  EXPECT_EQ(outcome.collisions, 1);
}

TEST(Judge, PostsAndDecoysAreObstacles) {
  const auto low = straight({-5, 10, 2}, {5, 10, 2});
  EXPECT_EQ(judge({{kRing}, {}}, low, kHalfSpan_m).collisions, 1);
  EXPECT_EQ(judge({{}, {{DecoyKind::kDisc, 0, {0, 10.8, 2}, 0, 0.5}}}, low, kHalfSpan_m).collisions, 1);
  EXPECT_EQ(judge({{}, {{DecoyKind::kDisc, 0, {0, 12, 2}, 0, 0.5}}}, low, kHalfSpan_m).collisions, 0);
}

TEST(Judge, TheWrongDirectionAndTheWrongPlaceAreNoCrossings) {
  const CourseOutcome back = judge({{kRing}, {}}, straight({5, 10, 6}, {-5, 10, 6}), kHalfSpan_m);
  EXPECT_EQ(back.crossed, 0);
  EXPECT_TRUE(back.crossings[0].backwards);
  const CourseOutcome beside = judge({{kRing}, {}}, straight({-5, 13, 6}, {5, 13, 6}), kHalfSpan_m);
  EXPECT_EQ(beside.crossed, 0);
  EXPECT_NEAR(beside.crossings[0].offset_m.value(), 3, 1e-9);
}

TEST(Judge, OrderIsThatOfTheCourse) {
  const Ring second{0, {8, 10, 6}, 90, 0};
  const auto path = straight({-5, 10, 6}, {14, 10, 6});
  EXPECT_TRUE(judge({{kRing, second}, {}}, path, kHalfSpan_m).in_order);
  const CourseOutcome other = judge({{second, kRing}, {}}, path, kHalfSpan_m);
  EXPECT_EQ(other.crossed, 2);
  EXPECT_FALSE(other.in_order);
}

// A circle of rings, each with the normal's sense that the array happens to have.
TEST(Course, LeadsClockwiseThroughTheRings) {
  std::vector<LocatedRing> rings;
  RingScene scene;
  for (const int i : {2, 0, 3, 1}) {
    LocatedRing ring;
    const double bearing = 40 + 90 * i;
    ring.center_m = 16 * direction(bearing, 0) + Eigen::Vector3d(0, 0, 5 + i % 2);
    ring.azimuth_deg = bearing + 90 + (i % 2 == 0 ? 180 : 15);
    rings.push_back(ring);
  }
  rings = in_order(rings);
  for (const LocatedRing& ring : rings) scene.rings.push_back({0, ring.center_m, ring.azimuth_deg, ring.lean_deg});
  EXPECT_NEAR(bearing_deg(rings[0].center_m), 40, 1e-9);
  Follower follower(line_through(rings, {-10, 20, 8}, {1, 0, 0}), 3.5, 2.1);
  // What follows turns its velocity within 0.4 s.
  PathPoint point{0, {-10, 20, 8}, {}, {}};
  Eigen::Vector3d velocity(3.5, 0, 0);
  std::vector<PathPoint> path;
  while (!follower.arrived() && path.size() < 10000) {
    velocity += 0.02 / 0.4 * (follower.velocity_mps(point.position_m) - velocity);
    point.position_m += 0.02 * velocity;
    point.time_s += 0.02;
    path.push_back(point);
  }
  const CourseOutcome outcome = judge(scene, path, kHalfSpan_m);
  EXPECT_TRUE(outcome.in_order);
  for (const Crossing& crossing : outcome.crossings) EXPECT_LT(crossing.offset_m.value(), 0.25);
  EXPECT_LT(path.size(), 2500u);
}

}  // namespace
}  // namespace pilotage
