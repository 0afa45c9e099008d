#include "pilotage/match/position_measurement.h"

#include <Eigen/LU>
#include <gtest/gtest.h>

#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

GeodeticPoint place(const Eigen::Vector2d& enu_m) {
  return LocalFrame({16.5, 55.5}).geodetic_from_enu({enu_m.x(), enu_m.y(), 0});
}

Eigen::Vector2d enu_m(const GeodeticPoint& point) {
  return LocalFrame({16.5, 55.5}).enu_from_geodetic(point).head<2>();
}

/// A prior, a measurement, and the fix that both make together.
struct Fused {
  Fused(const Eigen::Matrix2d& of_prior, const Eigen::Matrix2d& of_frame, const Eigen::Vector2d& measured_m) {
    prior.position = place({0, 0});
    prior.covariance_en_m2 = of_prior;
    const Eigen::Matrix2d fused = (of_prior.inverse() + of_frame.inverse()).inverse();
    fix.position = place(fused * of_frame.inverse() * measured_m);
    fix.covariance_en_m2 = fused + isotropic_covariance_m2(1);
    fix.map_sigma_m = 1;
  }
  MatchPrior prior;
  Fix fix;
};

TEST(PositionMeasurement, IsWhatTheFrameSaidBeforeThePriorWentIn) {
  Eigen::Matrix2d of_prior;
  of_prior << 9, 4, 4, 16;
  Eigen::Matrix2d of_frame;
  of_frame << 2, -0.5, -0.5, 1;
  const Fused fused(of_prior, of_frame, {5, -3});
  const PositionMeasurement alone = without_prior(fused.fix, fused.prior);
  EXPECT_LT((enu_m(alone.position) - Eigen::Vector2d(5, -3)).norm(), 1e-5);
  EXPECT_LT((alone.covariance_en_m2 - of_frame - isotropic_covariance_m2(1)).norm(), 1e-9);
}

TEST(PositionMeasurement, TheMapsOwnErrorIsTakenOffAndAddedAsItIsInTheFix) {
  Eigen::Matrix2d of_frame;
  of_frame << 2, -0.5, -0.5, 1;
  Fused fused(isotropic_covariance_m2(4), of_frame, {5, -3});
  fused.fix.covariance_en_m2 += isotropic_covariance_m2(5) - isotropic_covariance_m2(1);
  fused.fix.map_sigma_m = 5;
  const PositionMeasurement alone = without_prior(fused.fix, fused.prior);
  EXPECT_LT((enu_m(alone.position) - Eigen::Vector2d(5, -3)).norm(), 1e-5);
  EXPECT_LT((alone.covariance_en_m2 - of_frame - isotropic_covariance_m2(5)).norm(), 1e-9);
  EXPECT_EQ(alone.map_sigma_m, 5);
  // Fixes share all of it but what differs from place to place.
  EXPECT_LT((covariance_within_map(alone) - of_frame - isotropic_covariance_m2(1)).norm(), 1e-9);
}

TEST(PositionMeasurement, AFrameThatSaysNothingHasAHugeCovariance) {
  Fused fused(isotropic_covariance_m2(10), isotropic_covariance_m2(2), {1, 1});
  fused.fix.covariance_en_m2 = isotropic_covariance_m2(10) + isotropic_covariance_m2(1);
  const PositionMeasurement alone = without_prior(fused.fix, fused.prior);
  EXPECT_GT(alone.covariance_en_m2(0, 0), 1e7);
  EXPECT_TRUE(alone.covariance_en_m2.allFinite());
}

}  // namespace
}  // namespace pilotage
