#include "pilotage/match/pose_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>
#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include "pilotage/match/displacement_voting.h"

namespace pilotage {
namespace {

constexpr int kUnknowns = 6;
/// Variance of Cauchy's estimate with its scale at one standard deviation, over that of least squares, for normal
/// noise.
constexpr double kCauchyVariance = 1.325;
using State = Eigen::Matrix<double, kUnknowns, 1>;

/// The point where a ray turned by the rotation vector meets the ground. Rodrigues' formula to second order: with turns
/// of a few degrees what is left out is below 1e-5 of the height.
template <class T>
Eigen::Matrix<T, 2, 1> ground_point(const Eigen::Vector3d& ray_m, double rise_m, const T* state) {
  const Eigen::Matrix<T, 3, 1> turn(state[2], state[3], state[4]);
  const Eigen::Matrix<T, 3, 1>& ray = ray_m.cast<T>();
  const Eigen::Matrix<T, 3, 1> once = turn.cross(ray);
  const Eigen::Matrix<T, 3, 1> turned = ray + once + T(0.5) * turn.cross(once);
  using std::exp;
  const T height_m = T(-ray_m.z()) * exp(state[5]) - T(rise_m);
  const T along = height_m / -turned.z();
  return {state[0] + along * turned.x(), state[1] + along * turned.y()};
}

/// Residuals of the pairs, made robust, and of the prior, in units of their standard deviations.
struct PoseResiduals {
  const std::vector<GroundPair>* pairs;
  State prior_state;
  State prior_inverse_sigma;  ///< Of all but the position.
  Eigen::Matrix2d position_whitening;
  double noise_m;

  int NumResiduals() const { return 2 * static_cast<int>(pairs->size()) + kUnknowns; }

  template <class T>
  bool operator()(const T* state, T* residuals) const {
    int row = 0;
    for (const GroundPair& pair : *pairs) {
      const Eigen::Matrix<T, 2, 1> place = ground_point(pair.ray_m, pair.rise_m, state);
      const T x = (place.x() - T(pair.map_m.x())) / T(noise_m);
      const T y = (place.y() - T(pair.map_m.y())) / T(noise_m);
      // Cauchy's loss ln(1 + s) of s = x² + y²: both components shrink by the same factor.
      const T square = x * x + y * y;
      using std::log;
      using std::sqrt;
      const T factor = square < T(1e-8) ? T(1) : sqrt(log(T(1) + square) / square);
      residuals[row++] = factor * x;
      residuals[row++] = factor * y;
    }
    const T right = state[0] - T(prior_state(0));
    const T up = state[1] - T(prior_state(1));
    residuals[row++] = T(position_whitening(0, 0)) * right;
    residuals[row++] = T(position_whitening(1, 0)) * right + T(position_whitening(1, 1)) * up;
    for (int i = 2; i < kUnknowns; ++i) residuals[row++] = (state[i] - T(prior_state(i))) * T(prior_inverse_sigma(i));
    return true;
  }
};

using PoseFunction = ceres::TinySolverAutoDiffFunction<PoseResiduals, Eigen::Dynamic, kUnknowns>;

State inverse_sigmas(const PosePrior& prior) {
  State inverse;
  const auto of = [](double sigma) { return 1 / std::max(sigma, 1e-6); };
  inverse << 0, 0, of(prior.tilt_sigma_rad), of(prior.tilt_sigma_rad), of(prior.yaw_sigma_rad),
      of(prior.log_height_sigma);
  return inverse;
}

/// The lower triangle W with W C Wᵀ = 1: of an error of covariance C it makes two of variance 1.
Eigen::Matrix2d whitening(const Eigen::Matrix2d& covariance_m2) {
  const double first = std::max(std::sqrt(covariance_m2(0, 0)), 1e-6);
  const double shared = covariance_m2(1, 0) / first;
  const double second = std::max(std::sqrt(std::max(0.0, covariance_m2(1, 1) - shared * shared)), 1e-6);
  Eigen::Matrix2d matrix;
  matrix << 1 / first, 0, -shared / (first * second), 1 / second;
  return matrix;
}

std::vector<double> errors_m(const std::vector<GroundPair>& pairs, const State& state) {
  std::vector<double> errors;
  errors.reserve(pairs.size());
  for (const GroundPair& pair : pairs) {
    errors.push_back((ground_point(pair.ray_m, pair.rise_m, state.data()) - pair.map_m).norm());
  }
  return errors;
}

/// Standard deviation along one axis of a two-dimensional normal error from the median of its length.
double noise_from_median(std::vector<double> errors, double floor_m) {
  const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
  std::nth_element(errors.begin(), middle, errors.end());
  return std::max(*middle / 1.17741, floor_m);
}

State solve_state(const PoseResiduals& residuals, State state) {
  PoseFunction function(residuals);
  ceres::TinySolver<PoseFunction> solver;
  solver.Solve(function, &state);
  return state;
}

using Jet = ceres::Jet<double, kUnknowns>;

/// ground_point with its derivatives by the unknowns.
Eigen::Matrix<Jet, 2, 1> jet_point(const Eigen::Vector3d& ray_m, double rise_m, const State& state) {
  std::array<Jet, kUnknowns> jets;
  for (int i = 0; i < kUnknowns; ++i) jets[static_cast<std::size_t>(i)] = Jet(state(i), i);
  return ground_point(ray_m, rise_m, jets.data());
}

/// Information of the pairs about the unknowns; those beyond three standard deviations are left out.
Eigen::Matrix<double, kUnknowns, kUnknowns> information(const std::vector<GroundPair>& pairs, const State& state,
                                                        double noise_m) {
  Eigen::Matrix<double, kUnknowns, kUnknowns> sum = Eigen::Matrix<double, kUnknowns, kUnknowns>::Zero();
  for (const GroundPair& pair : pairs) {
    const auto place = jet_point(pair.ray_m, pair.rise_m, state);
    const Eigen::Vector2d error(place.x().a - pair.map_m.x(), place.y().a - pair.map_m.y());
    if (error.norm() > 3 * noise_m) continue;
    sum += place.x().v * place.x().v.transpose() + place.y().v * place.y().v.transpose();
  }
  return sum / (noise_m * noise_m * kPairsPerIndependentPair * kCauchyVariance);
}

}  // namespace

Eigen::Vector2d PoseCorrection::ground_from_ray(const Eigen::Vector3d& ray_m, double rise_m) const {
  const double state[kUnknowns] = {position_m.x(), position_m.y(), tilt_rad.x(), tilt_rad.y(), turn_rad, log_height};
  return ground_point(ray_m, rise_m, state);
}

Eigen::Matrix<double, 2, 6> PoseCorrection::ground_jacobian(const Eigen::Vector3d& ray_m, double rise_m) const {
  State state;
  state << position_m, tilt_rad, turn_rad, log_height;
  const auto place = jet_point(ray_m, rise_m, state);
  Eigen::Matrix<double, 2, 6> jacobian;
  jacobian << place.x().v.transpose(), place.y().v.transpose();
  return jacobian;
}

PoseCorrection refine_pose(const std::vector<GroundPair>& pairs, const PosePrior& prior,
                           const Eigen::Vector2d& prior_position_m, const Eigen::Vector2d& start_m, double floor_m) {
  PoseCorrection pose;
  pose.position_m = start_m;
  if (pairs.size() < 4) return pose;
  State state = State::Zero();
  state.head<2>() = start_m;
  PoseResiduals residuals{&pairs, State::Zero(), inverse_sigmas(prior), whitening(prior.position_covariance_m2),
                          std::max(1.0, floor_m)};
  residuals.prior_state.head<2>() = prior_position_m;
  // The noise is not known before the fit, nor the fit without the noise.
  for (int round = 0; round < 2; ++round) {
    state = solve_state(residuals, state);
    if (!state.allFinite()) return pose;
    residuals.noise_m = noise_from_median(errors_m(pairs, state), floor_m);
  }
  const std::vector<double> errors = errors_m(pairs, state);
  double sum_m2 = 0;
  for (const double error : errors) {
    if (!(error <= 3 * residuals.noise_m)) continue;
    ++pose.inliers;
    sum_m2 += error * error;
  }
  if (pose.inliers < 4) return pose;
  Eigen::Matrix<double, kUnknowns, kUnknowns> total = information(pairs, state, residuals.noise_m);
  total.diagonal() += residuals.prior_inverse_sigma.cwiseAbs2();
  total.topLeftCorner<2, 2>() += residuals.position_whitening.transpose() * residuals.position_whitening;
  pose.covariance = total.inverse();
  pose.position_m = state.head<2>();
  pose.tilt_rad = state.segment<2>(2);
  pose.turn_rad = state(4);
  pose.log_height = state(5);
  pose.residual_m = std::sqrt(sum_m2 / (2 * pose.inliers));
  pose.converged = pose.covariance.allFinite();
  return pose;
}

}  // namespace pilotage
