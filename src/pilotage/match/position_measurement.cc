#include "pilotage/match/position_measurement.h"

#include <algorithm>

#include <Eigen/Dense>

#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

constexpr double kLeastShare = 1e-6;  // of the prior's information

}  // namespace

PositionMeasurement without_prior(const Fix& fix, const MatchPrior& prior) {
  const Eigen::Matrix2d map_noise = isotropic_covariance_m2(fix.map_sigma_m);
  const Eigen::Matrix2d of_prior = prior.covariance_en_m2.inverse();
  const Eigen::Matrix2d of_fix = (fix.covariance_en_m2 - map_noise).inverse();
  const LocalFrame at_prior(prior.position);
  const Eigen::Vector2d off_m = at_prior.enu_from_geodetic(fix.position).head<2>();
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> information;
  information.computeDirect(of_fix - of_prior);
  const Eigen::Vector2d kept = information.eigenvalues().cwiseMax(kLeastShare * of_prior.trace());
  const Eigen::Matrix2d covariance =
      information.eigenvectors() * kept.cwiseInverse().asDiagonal() * information.eigenvectors().transpose();
  const Eigen::Vector2d measured_m = covariance * of_fix * off_m;
  return {at_prior.geodetic_from_enu({measured_m.x(), measured_m.y(), 0}), covariance + map_noise,
          fix.map_error_is_shared ? fix.map_sigma_m : 0};
}

Eigen::Matrix2d covariance_within_map(const PositionMeasurement& measurement) {
  const double own_sigma_m = std::min(measurement.map_sigma_m, kUnknownMapSigma_m);
  return measurement.covariance_en_m2 - isotropic_covariance_m2(measurement.map_sigma_m) +
         isotropic_covariance_m2(own_sigma_m);
}

}  // namespace pilotage
