#include "locate_rings.h"

#include <cmath>

#include "rings/ring_views.h"
#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "pilotage/base/random.h"
#include "pilotage/base/statistics.h"

namespace pilotage {
namespace {

using testing::circle_of;
using testing::looking;
using testing::pixel_of;

constexpr double kPlace_m = 0.1;
constexpr double kTurn_rad = 0.004;

Eigen::Matrix<double, 6, 6> pose_covariance() {
  Eigen::Matrix<double, 6, 1> variances;
  variances << Eigen::Vector3d::Constant(kPlace_m * kPlace_m), Eigen::Vector3d::Constant(kTurn_rad * kTurn_rad);
  return variances.asDiagonal();
}

Eigen::Vector3d draw3(Random& random, double sigma) {
  const double x = random.normal();
  const double y = random.normal();
  return sigma * Eigen::Vector3d(x, y, random.normal());
}

/// What an ideal detector would say of a ring, and a pose that is off by as many sigmas as `errors` says.
RingSight sight_of(const Ring& ring, const Eigen::Vector3d& from, double errors, Random& random) {
  const CameraPose truth = looking(from, {0, 0, 5});
  std::vector<cv::Point2f> points;
  for (const Eigen::Vector3d& point : circle_of(ring, 40)) {
    const Eigen::Vector2d pixel = pixel_of(point, forward_camera(), truth);
    points.emplace_back(static_cast<float>(pixel.x()), static_cast<float>(pixel.y()));
  }
  const cv::RotatedRect box = cv::fitEllipseDirect(points);
  const bool wide = box.size.width > box.size.height;
  RingSight sight;
  sight.seen = {ring.ring_class,
                {box.center.x, box.center.y},
                0.5 * std::max(box.size.width, box.size.height),
                0.5 * std::min(box.size.width, box.size.height),
                (box.angle + (wide ? 0 : 90)) * std::numbers::pi / 180,
                ring.kind().inner_radius_m / (ring.kind().inner_radius_m + 2 * ring.kind().tube_radius_m),
                0.25};
  sight.seen.center_px += errors * draw3(random, 0.1).head<2>();
  const Eigen::Vector3d turn = errors * draw3(random, kTurn_rad);
  sight.pose = truth;
  sight.pose.position_m += errors * draw3(random, kPlace_m);
  if (turn.norm() > 0) {
    sight.pose.enu_from_camera = Eigen::AngleAxisd(turn.norm(), turn.normalized()) * truth.enu_from_camera;
  }
  sight.pose_covariance = pose_covariance();
  return sight;
}

std::vector<RingSight> arc_of(const Ring& ring, int views, double arc_deg, double errors, Random& random) {
  std::vector<RingSight> sights;
  for (int i = 0; i < views; ++i) {
    const double at_deg = ring.azimuth_deg + 180 + arc_deg * (i / std::max(1.0, views - 1.0) - 0.5);
    sights.push_back(sight_of(ring, 22 * direction(at_deg, 0) + Eigen::Vector3d(0, 0, 10), errors, random));
  }
  return sights;
}

TEST(LocateRings, ExactSightsGiveTheRing) {
  Random random(1);
  for (const double azimuth_deg : {10.0, 80.0, 140.0}) {
    const Ring ring{1, {2, -3, 6.5}, azimuth_deg, 4};
    const RingArray array = locate_rings(arc_of(ring, 6, 100, 0, random), forward_camera());
    ASSERT_EQ(array.rings.size(), 1u);
    const LocatedRing& found = array.rings[0];
    EXPECT_LT((found.center_m - ring.center_m).norm(), 0.01);
    EXPECT_NEAR(std::remainder(found.azimuth_deg - azimuth_deg, 180), 0, 0.1);
    EXPECT_NEAR(std::abs(found.lean_deg), 4, 0.1);
    EXPECT_NEAR(found.inner_radius_m, 1.5, 0.01);
    EXPECT_EQ(found.views, 6);
  }
}

// Poses with independent errors: the covariance adds their mean once more, so it is wide but never narrow.
TEST(LocateRings, CovarianceHoldsTheErrors) {
  Random random(2);
  double nees = 0;
  double squared_m2 = 0;
  constexpr int kRuns = 60;
  for (int i = 0; i < kRuns; ++i) {
    const Ring ring{i % 2, {random.uniform(-5, 5), random.uniform(-5, 5), 6}, random.uniform(0, 180), 0};
    const RingArray array = locate_rings(arc_of(ring, 8, 110, 1, random), forward_camera());
    ASSERT_EQ(array.rings.size(), 1u) << i;
    const Eigen::Vector3d off = array.rings[0].center_m - ring.center_m;
    nees += off.dot(array.rings[0].covariance_m2.inverse() * off) / kRuns;
    squared_m2 += off.squaredNorm() / kRuns;
  }
  EXPECT_LT(nees, chi_squared_quantile(0.975, 3 * kRuns) / kRuns);
  EXPECT_GT(nees, 0.2);
  EXPECT_LT(std::sqrt(squared_m2), std::sqrt(3.0) * kPlace_m) << "many views are better than one pose";
}

TEST(LocateRings, OneBadSightDoesNotMoveTheRing) {
  Random random(3);
  const Ring ring{0, {0, 0, 6}, 20, 0};
  std::vector<RingSight> sights = arc_of(ring, 7, 100, 0, random);
  sights[3].seen.center_px += Eigen::Vector2d(40, 25);
  const LocatedRing found = triangulate_ring(sights, forward_camera(), ring.center_m);
  EXPECT_LT((found.center_m - ring.center_m).norm(), 0.05);
  EXPECT_EQ(found.views, 6);
}

TEST(LocateRings, NeighboursStayTwoRings) {
  Random random(4);
  std::vector<RingSight> sights = arc_of({0, {-2.5, 0, 6}, 0, 0}, 5, 80, 0.5, random);
  for (const RingSight& sight : arc_of({0, {2.5, 0, 6}, 0, 0}, 5, 80, 0.5, random)) sights.push_back(sight);
  EXPECT_EQ(locate_rings(sights, forward_camera()).rings.size(), 2u);
}

RefusedRing refusal_of(const std::vector<RingSight>& sights) {
  const RingArray array = locate_rings(sights, forward_camera());
  return array.rings.empty() && array.refused.size() == 1 ? array.refused[0].why : RefusedRing::kNone;
}

TEST(LocateRings, WhatIsNoStandingRingOfItsKindIsRefused) {
  Random random(5);
  const Ring ring{0, {0, 0, 6}, 0, 0};
  EXPECT_EQ(refusal_of(arc_of(ring, 2, 60, 0, random)), RefusedRing::kFewViews);
  EXPECT_EQ(refusal_of(arc_of(ring, 5, 8, 0, random)), RefusedRing::kNarrow);
  EXPECT_EQ(refusal_of(arc_of({0, {0, 0, 0}, 0, 90}, 6, 100, 0, random)), RefusedRing::kLying);
  std::vector<RingSight> larger = arc_of({1, {0, 0, 6}, 0, 0}, 6, 25, 0, random);
  for (RingSight& sight : larger) sight.seen.ring_class = 0;
  EXPECT_EQ(refusal_of(larger), RefusedRing::kRadius);
}

}  // namespace
}  // namespace pilotage
