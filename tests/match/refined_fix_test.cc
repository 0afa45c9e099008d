#include "pilotage/match/refined_fix.h"

#include <cmath>

#include "match/flown_frame.h"
#include <gtest/gtest.h>

#include "pilotage/match/place_ranking.h"

namespace pilotage {
namespace {

using testing::FlownFrame;

/// A frame rectified, described, and its best place.
struct Placed {
  explicit Placed(const FlownFrame& flown)
      : map(MapReader::open_unverified(flown.path)), rectified(flown.rectify(map)), described(describe(rectified, {})) {
    local = flown.local_map(map, rectified, described);
    place = rank_places(described, local, search_space(rectified, local, flown.options), std::nullopt, rectified.gsd_m)
                .value()
                .best.match;
  }
  std::optional<RefinedFix> refine(const FlownFrame& flown) const {
    return refine_fix(rectified, described, local, flown.prior, flown.options, place);
  }

  MapReader map;
  FrameOnGrid rectified;
  PivotedFrame described;
  LocalMap local;
  GuidedMatch place;
};

TEST(RefineFix, IsThePlaceOfTheAircraft) {
  const FlownFrame flown;
  const auto refined = Placed(flown).refine(flown);
  ASSERT_TRUE(refined.has_value());
  const Fix& fix = refined->fix;
  const GeodeticPoint truth = flown.place(FlownFrame::kEast_m, FlownFrame::kNorth_m);
  EXPECT_LT(testing::metres_between(fix.position, truth), 1);
  EXPECT_LT(testing::metres_between(fix.center, truth), 0.5) << "the camera looks straight down";
  EXPECT_LT(std::abs(std::remainder(fix.yaw_deg - 30, 360.0)), 0.5);
  EXPECT_NEAR(fix.height_agl_m, flown.ground.agl_m, 1);
  EXPECT_NEAR(fix.scale, fix.height_agl_m / flown.prior.height_agl_m, 1e-12);
  EXPECT_GT(refined->pose.inliers, 20);
}

TEST(RefineFix, TheMapsOwnErrorIsInTheCovariance) {
  FlownFrame flown;
  const Placed placed(flown);
  flown.options.map_sigma_m = 0;
  const auto exact = placed.refine(flown);
  flown.options.map_sigma_m = 3;
  const auto vague = placed.refine(flown);
  ASSERT_TRUE(exact.has_value());
  ASSERT_TRUE(vague.has_value());
  const Eigen::Matrix2d nine = 9 * Eigen::Matrix2d::Identity();
  EXPECT_LT((vague->fix.covariance_en_m2 - exact->fix.covariance_en_m2 - nine).norm(), 1e-9);
  EXPECT_LT((vague->fix.center_covariance_en_m2 - exact->fix.center_covariance_en_m2 - nine).norm(), 1e-9);
  EXPECT_GT(exact->fix.covariance_en_m2(0, 0), 0);
}

TEST(RefineFix, NothingWithoutSupporters) {
  const FlownFrame flown;
  Placed placed(flown);
  placed.place.placement.center_px += Eigen::Vector2d(5000, 5000);
  EXPECT_FALSE(placed.refine(flown).has_value());
}

/// One pose after another against the gates of a prior 40 m wide.
class Gate : public ::testing::Test {
 protected:
  Gate() {
    rectified_.gsd_m = 0.5;
    rectified_.prior_px = {100, 200};
    prior_.sigma_m = 10;
    prior_.height_agl_m = 100;
    options_.attitude_sigma_deg = 1;
    options_.yaw_sigma_deg = 2;
    options_.height_sigma_fraction = 0.03;
    pose_.position_m = rectified_.m_from_px(rectified_.prior_px);
  }
  bool outside() const { return is_outside_gate(rectified_, map_, prior_, options_, pose_); }

  FrameOnGrid rectified_;
  LocalMap map_;
  MatchPrior prior_;
  MatchOptions options_;
  PoseCorrection pose_;
};

TEST_F(Gate, HoldsThePriorItself) {
  EXPECT_FALSE(outside());
}

TEST_F(Gate, OfPositionIsTheSearchedSquare) {
  const double half_m = search_half_width_m(prior_, options_);
  const Eigen::Vector2d start_m = pose_.position_m;
  for (const Eigen::Vector2d& along : {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, -1), Eigen::Vector2d(1, -1)}) {
    pose_.position_m = start_m + 0.999 * half_m * along;
    EXPECT_FALSE(outside()) << along.transpose();
    pose_.position_m = start_m + 1.001 * half_m * along;
    EXPECT_TRUE(outside()) << along.transpose();
  }
}

TEST_F(Gate, OfTiltIsFourStandardDeviations) {
  pose_.tilt_rad = {3.9 * kRadPerDeg, 0};
  EXPECT_FALSE(outside());
  pose_.tilt_rad = {3 * kRadPerDeg, 3 * kRadPerDeg};  // 4.2° together
  EXPECT_TRUE(outside());
}

TEST_F(Gate, OfYawHoldsOnlyWhereYawIsKnown) {
  pose_.turn_rad = -7.9 * kRadPerDeg;
  EXPECT_FALSE(outside());
  pose_.turn_rad = -8.1 * kRadPerDeg;
  EXPECT_TRUE(outside());
  options_.yaw_sigma_deg = 180;
  EXPECT_FALSE(outside());
}

TEST_F(Gate, OfHeightIsFourStandardDeviations) {
  for (const double sign : {-1.0, 1.0}) {
    pose_.log_height = 0.119 * sign;
    EXPECT_FALSE(outside()) << sign;
    pose_.log_height = 0.121 * sign;
    EXPECT_TRUE(outside()) << sign;
  }
}

}  // namespace
}  // namespace pilotage
