#include "pilotage/match/frame_on_grid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "match/flown_frame.h"
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using testing::FlownFrame;

TEST(SearchHalfWidth, IsThePriorsWindowAndWhatTiltMoves) {
  MatchPrior prior;
  prior.covariance_en_m2 = isotropic_covariance_m2(10);
  prior.height_agl_m = 100;
  MatchOptions options;
  options.search_sigmas = 3;
  options.attitude_sigma_deg = 1;
  EXPECT_NEAR(search_half_width_m(prior, options), 30 + 2 * 100 * std::tan(std::numbers::pi / 180), 1e-12);
  options.search_sigmas = 1;
  EXPECT_NEAR(search_half_width_m(prior, options), 10 + 2 * 100 * std::tan(std::numbers::pi / 180), 1e-12);
}

TEST(AttitudeOnGrid, IsTurnedByTheConvergenceAlone) {
  LocalGrid grid;
  const double turn_rad = 2 * std::numbers::pi / 180;  // the grid's up points to 2° east of north
  grid.enu_from_px << 0.5 * std::cos(turn_rad), -0.5 * std::sin(turn_rad), -0.5 * std::sin(turn_rad),
      -0.5 * std::cos(turn_rad);
  ASSERT_NEAR(std::abs(grid.convergence_deg()), 2, 1e-9);
  const Attitude turned = attitude_on_grid({30, 4, -5}, grid);
  EXPECT_NEAR(turned.yaw_deg, 30 - grid.convergence_deg(), 1e-12);
  EXPECT_EQ(turned.pitch_deg, 4);
  EXPECT_EQ(turned.roll_deg, -5);
}

TEST(FrameOnGrid, LengthsOfPixelsPointDown) {
  FrameOnGrid rectified;
  rectified.gsd_m = 0.5;
  EXPECT_EQ(rectified.px_from_m({3, 4}), Eigen::Vector2d(6, -8));
  EXPECT_EQ(rectified.m_from_px({6, -8}), Eigen::Vector2d(3, 4));
}

TEST(FrameOnGrid, LiesWhereThePriorPutsIt) {
  const FlownFrame flown;
  MapReader map = MapReader::open_unverified(flown.path);
  const FrameOnGrid rectified = flown.rectify(map);
  ASSERT_NE(rectified.level, nullptr);
  EXPECT_NEAR(rectified.gsd_m, 0.5, 0.001);
  EXPECT_LT(testing::metres_between(rectified.grid.geodetic_from_px(rectified.prior_px), flown.prior.position), 1e-3);
  EXPECT_NEAR(rectified.half_width_px, search_half_width_m(flown.prior, flown.options) / rectified.gsd_m, 1e-9);
  EXPECT_LT(rectified.pivot_m.norm(), 1e-6) << "a camera that looks straight down shows the nadir in its middle";
  EXPECT_FALSE(rectified.frame.gray.empty());
}

TEST(FrameOnGrid, ATiltMovesThePivot) {
  const FlownFrame flown({0, 10, 0});  // nose up: what the camera looks at lies ahead, to the grid's up
  MapReader map = MapReader::open_unverified(flown.path);
  const FrameOnGrid rectified = flown.rectify(map);
  const double ahead_m = flown.ground.agl_m * std::tan(10 * std::numbers::pi / 180);
  EXPECT_NEAR(rectified.pivot_m.norm(), ahead_m, 1e-6);
  EXPECT_GT(rectified.pivot_m.y(), 0.99 * ahead_m);
}

TEST(FrameOnGrid, NothingIsLaidOffTheMap) {
  FlownFrame flown;
  MapReader map = MapReader::open_unverified(flown.path);
  flown.prior.position = flown.place(20000, 0);
  EXPECT_TRUE(flown.rectify(map).frame.gray.empty());
}

TEST(FrameOnGrid, NothingIsLaidInAWindowTooLargeToSearch) {
  FlownFrame flown;
  MapReader map = MapReader::open_unverified(flown.path);
  flown.prior.covariance_en_m2 = isotropic_covariance_m2(900);  // 3 · 900 / 0.5 pixels, more than 4096
  EXPECT_TRUE(flown.rectify(map).frame.gray.empty());
  flown.prior.covariance_en_m2 = isotropic_covariance_m2(600);
  EXPECT_FALSE(flown.rectify(map).frame.gray.empty());
}

TEST(FrameOnGrid, IsDescribedAboutItsPivot) {
  const FlownFrame flown({0, 6, -3});
  MapReader map = MapReader::open_unverified(flown.path);
  const FrameOnGrid rectified = flown.rectify(map);
  const PivotedFrame described = describe(rectified, {});
  ASSERT_GT(described.grid.points.size(), 100);
  EXPECT_LT((rectified.frame.ground_from_pixel(described.pivot_px) - rectified.pivot_m).norm(), 1e-9);
  double farthest_px = 0;
  for (const Feature& point : described.grid.points.features) {
    farthest_px = std::max(farthest_px, std::hypot(static_cast<double>(point.x_px) - described.pivot_px.x(),
                                                   static_cast<double>(point.y_px) - described.pivot_px.y()));
  }
  EXPECT_NEAR(described.radius_px, farthest_px, 1e-9);
}

TEST(SearchSpaceOfFrame, IsCentredOnThePivot) {
  FlownFrame flown({0, 6, -3});
  flown.options.yaw_sigma_deg = 2;
  flown.options.height_sigma_fraction = 0.05;
  MapReader map = MapReader::open_unverified(flown.path);
  const FrameOnGrid rectified = flown.rectify(map);
  const LocalMap local = flown.local_map(map, rectified, describe(rectified, {}));
  const SearchSpace space = search_space(rectified, local, flown.options);
  const Eigen::Vector2d pivot_px(rectified.pivot_m.x() / rectified.gsd_m, -rectified.pivot_m.y() / rectified.gsd_m);
  EXPECT_LT((space.center_px + local.reference_px - rectified.prior_px - pivot_px).norm(), 1e-9);
  EXPECT_EQ(space.half_width_px, rectified.half_width_px);
  EXPECT_NEAR(space.yaw_sigma_rad, 2 * std::numbers::pi / 180, 1e-15);
  EXPECT_EQ(space.scale_sigma, 0.05);
}

}  // namespace
}  // namespace pilotage
