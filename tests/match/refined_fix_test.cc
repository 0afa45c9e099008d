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
    place = rank_places(described, local, search_space(rectified, local, flown.options), std::nullopt, std::nullopt,
                        rectified.gsd_m)
                .value()
                .best;
  }
  std::optional<RefinedFix> refine(const FlownFrame& flown) const {
    return refine_fix(rectified, described, local, flown.prior, flown.options, place);
  }

  MapReader map;
  FrameOnGrid rectified;
  PivotedFrame described;
  LocalMap local;
  RankedPlace place;
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
  const FlownFrame flown;
  const Placed placed(flown);
  const auto exact = placed.refine(flown);
  auto vague = exact;
  ASSERT_TRUE(exact.has_value());
  add_map_error(vague->fix, 3);
  EXPECT_EQ(vague->fix.map_sigma_m, 3);
  const Eigen::Matrix2d nine = 9 * Eigen::Matrix2d::Identity();
  EXPECT_LT((vague->fix.covariance_en_m2 - exact->fix.covariance_en_m2 - nine).norm(), 1e-9);
  EXPECT_LT((vague->fix.center_covariance_en_m2 - exact->fix.center_covariance_en_m2 - nine).norm(), 1e-9);
  EXPECT_GT(exact->fix.covariance_en_m2(0, 0), 0);
}

TEST(RefineFix, NothingWithoutSupporters) {
  const FlownFrame flown;
  Placed placed(flown);
  placed.place.match.placement.center_px += Eigen::Vector2d(5000, 5000);
  EXPECT_FALSE(placed.refine(flown).has_value());
}

TEST(RefineFix, WhereChipsDecideIsAsUncertainAsChancePairsMakeIt) {
  const FlownFrame flown;
  Placed placed(flown);
  const auto alone = placed.refine(flown);
  const double support = placed.place.match.evidence();
  const auto sigma_m = [&](double chance_share) {
    placed.place.chips_decide = true;
    placed.place.chance_support = chance_share * support;
    const auto refined = placed.refine(flown);
    return refined ? std::sqrt(refined->fix.center_covariance_en_m2(0, 0)) : 0;
  };
  ASSERT_TRUE(alone.has_value());
  const double of_residuals_m = std::sqrt(alone->fix.center_covariance_en_m2(0, 0));
  EXPECT_NEAR(sigma_m(0), of_residuals_m, 1e-9);
  const double of_half_m = sigma_m(0.5);  // twice as far off, but for what attitude and prior have in it
  EXPECT_GT(of_half_m, 1.5 * of_residuals_m);
  EXPECT_LE(of_half_m, 2 * of_residuals_m);
  EXPECT_NEAR(sigma_m(1), of_half_m, 1e-9) << "twice at most";
  EXPECT_NEAR(sigma_m(1.5), of_half_m, 1e-9) << "fewer than chance gives";
  placed.place.chips_decide = false;
  EXPECT_EQ(std::sqrt(placed.refine(flown)->fix.center_covariance_en_m2(0, 0)), of_residuals_m);
}

/// One fix after another against the gates of a prior of 10 m.
class Gate : public ::testing::Test {
 protected:
  Gate() {
    prior_.position = {16.5, 55.5};
    prior_.covariance_en_m2 = isotropic_covariance_m2(10);
    prior_.height_agl_m = 100;
    prior_.attitude = {359, 1, -2};
    options_.attitude_sigma_deg = 1;
    options_.yaw_sigma_deg = 2;
    options_.height_sigma_fraction = 0.03;
    fix_.position = prior_.position;
    fix_.yaw_deg = 359;
    fix_.pitch_deg = 1;
    fix_.roll_deg = -2;
  }
  bool outside() const { return is_outside_gate(fix_, prior_, options_); }
  bool outside_at(const Eigen::Vector2d& off_m) {
    fix_.position = LocalFrame(prior_.position).geodetic_from_enu({off_m.x(), off_m.y(), 0});
    return outside();
  }

  Fix fix_;
  MatchPrior prior_;
  MatchOptions options_;
};

TEST_F(Gate, HoldsThePriorItself) {
  EXPECT_FALSE(outside());
}

TEST_F(Gate, OfPositionIsTheEllipseAboutTheToldSquare) {
  const double by_tilt_m = 2 * 100 * std::tan(kRadPerDeg);
  prior_.covariance_en_m2 << 400, 0, 0, 25;
  const Eigen::Vector2d half_axes =
      std::sqrt(2) * Eigen::Vector2d(std::hypot(60, by_tilt_m), std::hypot(15, by_tilt_m));
  for (const double angle : {0.9, 1.5, 2.2}) {  // where the searched square does not cut the ellipse off
    const Eigen::Vector2d edge(half_axes.x() * std::cos(angle), half_axes.y() * std::sin(angle));
    EXPECT_FALSE(outside_at(0.999 * edge)) << angle;
    EXPECT_TRUE(outside_at(1.001 * edge)) << angle;
  }
  const double half_width_m = search_half_width_m(prior_, options_);
  EXPECT_FALSE(outside_at({0.999 * half_width_m, 0}));
  EXPECT_TRUE(outside_at({1.001 * half_width_m, 0}));
}

TEST_F(Gate, OfPositionFollowsTheCorrelation) {
  prior_.covariance_en_m2 << 100, 90, 90, 100;  // 13.8 m along (1, 1), 3.2 m across
  EXPECT_FALSE(outside_at({25, 25}));
  EXPECT_TRUE(outside_at({17, -17}));
}

TEST_F(Gate, OfTiltIsFourStandardDeviations) {
  fix_.pitch_deg = 1 + 3.9;
  EXPECT_FALSE(outside());
  fix_.pitch_deg = 1 + 3;
  fix_.roll_deg = -2 - 3;  // 4.2° together
  EXPECT_TRUE(outside());
}

TEST_F(Gate, OfYawHoldsOnlyWhereYawIsKnown) {
  fix_.yaw_deg = 359 + 7.9 - 360;
  EXPECT_FALSE(outside());
  fix_.yaw_deg = 359 + 8.1 - 360;
  EXPECT_TRUE(outside());
  options_.yaw_sigma_deg = 180;
  EXPECT_FALSE(outside());
}

TEST_F(Gate, OfHeightIsFourStandardDeviations) {
  for (const double sign : {-1.0, 1.0}) {
    fix_.scale = std::exp(0.119 * sign);
    EXPECT_FALSE(outside()) << sign;
    fix_.scale = std::exp(0.121 * sign);
    EXPECT_TRUE(outside()) << sign;
  }
}

}  // namespace
}  // namespace pilotage
