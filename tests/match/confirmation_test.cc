#include "pilotage/match/confirmation.h"

#include <cmath>
#include <numbers>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "pilotage/base/random.h"
#include "pilotage/base/statistics.h"
#include "pilotage/match/match_confidence.h"

namespace pilotage {
namespace {

const Eigen::Matrix2d kCovariance = (Eigen::Matrix2d() << 6, 2, 2, 4).finished();

TEST(Confirmation, AgreementIsTheEllipseOfItsShare) {
  Random random(seed_from_name("agreement"));
  const Eigen::Matrix2d root = kCovariance.llt().matrixL();
  constexpr int kDraws = 20000;
  int agree = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double first = random.normal();
    agree += agrees_with_track(root * Eigen::Vector2d(first, random.normal()), kCovariance) ? 1 : 0;
  }
  const Interval interval = binomial_interval(agree, kDraws, 0.999);
  EXPECT_LE(interval.low, kAgreementShare);
  EXPECT_GE(interval.high, kAgreementShare);
}

TEST(Confirmation, RateFallsWithEvidenceAndWithTheEllipse) {
  const double area_m2 = std::numbers::pi * kAgreementChiSquared * std::sqrt(kCovariance.determinant());
  const double window_m2 = std::pow(2 * kCalibratedHalfWidthPx * 0.5, 2);
  EXPECT_NEAR(false_confirmation_rate(3, kCovariance, 0.5), std::exp(-3.0) * area_m2 / window_m2, 1e-15);
  EXPECT_NEAR(false_confirmation_rate(3, 4 * kCovariance, 0.5), 4 * false_confirmation_rate(3, kCovariance, 0.5),
              1e-15);
  EXPECT_EQ(false_confirmation_rate(0, 1e9 * kCovariance, 0.5), 1) << "an ellipse larger than the window is the window";
}

/// Frames of other ground: a best place anywhere in the calibrated window, its evidence exponential.
TEST(Confirmation, OtherGroundIsConfirmedAtTheRateAskedFor) {
  constexpr double kGsd_m = 0.5;
  constexpr double kRate = 0.002;
  constexpr int kFrames = 400000;
  const double half_m = kCalibratedHalfWidthPx * kGsd_m;
  Random random(seed_from_name("other ground"));
  int confirmed = 0;
  for (int i = 0; i < kFrames; ++i) {
    const double east_m = random.uniform(-half_m, half_m);
    const Eigen::Vector2d off_m(east_m, random.uniform(-half_m, half_m));
    const double evidence = -std::log(1 - random.uniform());
    if (!agrees_with_track(off_m, kCovariance)) continue;
    confirmed += false_confirmation_rate(evidence, kCovariance, kGsd_m) <= kRate ? 1 : 0;
  }
  const Interval interval = binomial_interval(confirmed, kFrames, 0.999);
  EXPECT_LE(interval.low, kRate);
  EXPECT_GE(interval.high, kRate);
}

}  // namespace
}  // namespace pilotage
