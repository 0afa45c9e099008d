#include "pilotage/match/confirmation.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/LU>

#include "pilotage/geo/position_covariance.h"
#include "pilotage/match/match_confidence.h"

namespace pilotage {

bool agrees_with_track(const Eigen::Vector2d& difference_m, const Eigen::Matrix2d& covariance_m2) {
  return mahalanobis_squared(difference_m, covariance_m2) <= kAgreementChiSquared;
}

double false_confirmation_rate(double evidence, const Eigen::Matrix2d& covariance_m2, double gsd_m) {
  const double agreement_m2 =
      std::numbers::pi * kAgreementChiSquared * std::sqrt(std::max(0.0, covariance_m2.determinant()));
  const double side_m = 2 * kCalibratedHalfWidthPx * gsd_m;
  return std::exp(-evidence) * std::min(1.0, agreement_m2 / (side_m * side_m));
}

}  // namespace pilotage
