#include "pilotage/match/pose_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Dense>
#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include "pilotage/base/statistics.h"
#include "pilotage/match/displacement_voting.h"

namespace pilotage {
namespace {

constexpr int kUnknowns = 6;
/// Variance of Cauchy's estimate with its scale at one standard deviation, over that of least squares, for normal
/// noise.
constexpr double kCauchyVariance = 1.325;
using State = Eigen::Matrix<double, kUnknowns, 1>;
using StateMatrix = Eigen::Matrix<double, kUnknowns, kUnknowns>;
/// Of the squares of ground whose pairs count together: what neighbours share hardly changes within one.
constexpr double kCellsInLength = 4;  // of PosePrior::lean_length_m
constexpr double kMostCellsAcross = 16;

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

/// Residuals of the pairs, made robust, and of the prior attitude and height, in units of their standard deviations.
/// The prior position is no residual: add_position_prior().
struct PoseResiduals {
  const std::vector<GroundPair>* pairs;
  State prior_inverse_sigma;
  double noise_m;

  int NumResiduals() const { return 2 * static_cast<int>(pairs->size()) + kUnknowns - 2; }

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
    for (int i = 2; i < kUnknowns; ++i) residuals[row++] = state[i] * T(prior_inverse_sigma(i));
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
  return std::max(*middle / kMedianOfLengths, floor_m);
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

/// What pairs close to each other do to the unknowns together: sums of Jᵀ / noise², by the axes of an error of their
/// map points and by an error of the ground's height.
struct GroundCell {
  Eigen::Vector2d place_m{0, 0};
  State by_x = State::Zero();
  State by_y = State::Zero();
  State by_height = State::Zero();
  double pairs = 0;
};

/// The derivative of ground_point by rise_m: a ray that meets higher ground meets it nearer to the nadir.
Eigen::Vector2d by_rise(const Eigen::Vector3d& ray_m, const State& state) {
  return ground_point(ray_m, 1, state.data()) - ground_point(ray_m, 0, state.data());
}

/// The pairs within three standard deviations.
struct Inliers {
  StateMatrix information = StateMatrix::Zero();  ///< Σ Jᵀ J / noise²: as the solver weights them.
  std::vector<GroundCell> cells;
};

Inliers sum_inliers(const std::vector<GroundPair>& pairs, const State& state, const PosePrior& prior, double noise_m) {
  double reach_m = 0;
  for (const GroundPair& pair : pairs)
    reach_m = std::max(reach_m, (pair.map_m - state.head<2>()).cwiseAbs().maxCoeff());
  const double cell_m = std::max(prior.lean_length_m / kCellsInLength, 2 * reach_m / kMostCellsAcross);
  std::map<std::pair<int, int>, GroundCell> cells;  // in order: sums are the same every time
  Inliers sums;
  for (const GroundPair& pair : pairs) {
    const auto place = jet_point(pair.ray_m, pair.rise_m, state);
    const Eigen::Vector2d error(place.x().a - pair.map_m.x(), place.y().a - pair.map_m.y());
    if (error.norm() > 3 * noise_m) continue;
    const State by_x = place.x().v / (noise_m * noise_m);
    const State by_y = place.y().v / (noise_m * noise_m);
    sums.information += by_x * place.x().v.transpose() + by_y * place.y().v.transpose();
    const Eigen::Vector2d at = (pair.map_m - state.head<2>()) / cell_m;
    GroundCell& cell = cells[{static_cast<int>(std::floor(at.x())), static_cast<int>(std::floor(at.y()))}];
    const Eigen::Vector2d rising = by_rise(pair.ray_m, state);
    cell.place_m += pair.map_m;
    cell.by_x += by_x;
    cell.by_y += by_y;
    cell.by_height += rising.x() * by_x + rising.y() * by_y;
    cell.pairs += 1;
  }
  for (auto& [key, cell] : cells) {
    cell.place_m /= cell.pairs;
    sums.cells.push_back(cell);
  }
  return sums;
}

/// What errors that neighbours share do to the unknowns, before the solver's gain: those of the map's points, and those
/// of its heights, which count against the height under the aircraft.
StateMatrix shared_errors(const std::vector<GroundCell>& cells, const Eigen::Vector2d& nadir_m,
                          const PosePrior& prior) {
  StateMatrix sum = StateMatrix::Zero();
  State at_nadir = State::Zero();
  for (const GroundCell& cell : cells) at_nadir -= cell.by_height;
  const auto likeness = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b, double length_m) {
    return std::exp(-(a - b).squaredNorm() / (2 * length_m * length_m));
  };
  const double lean_m2 = std::pow(prior.pair_error_factor * prior.lean_sigma_m, 2);
  const double height_m2 = prior.height_sigma_m * prior.height_sigma_m;
  sum += height_m2 * at_nadir * at_nadir.transpose();
  for (const GroundCell& a : cells) {
    State by_x = State::Zero();
    State by_y = State::Zero();
    State by_height = likeness(a.place_m, nadir_m, kHeightErrorLength_m) * at_nadir;
    for (const GroundCell& b : cells) {
      const double leaning = likeness(a.place_m, b.place_m, prior.lean_length_m);
      by_x += leaning * b.by_x;
      by_y += leaning * b.by_y;
      by_height += likeness(a.place_m, b.place_m, kHeightErrorLength_m) * b.by_height;
    }
    sum += lean_m2 * (a.by_x * by_x.transpose() + a.by_y * by_y.transpose());
    sum += height_m2 * a.by_height * by_height.transpose();
    sum += height_m2 * likeness(a.place_m, nadir_m, kHeightErrorLength_m) * at_nadir * a.by_height.transpose();
  }
  return (sum + sum.transpose()) / 2;
}

/// What the frame alone says, with the prior attitude and height: the covariance of the solver's answer when pairs are
/// as far off as they are, by themselves (one in kPairsPerIndependentPair independent) and together.
StateMatrix frame_covariance(const std::vector<GroundPair>& pairs, const State& state, const PosePrior& prior,
                             double noise_m) {
  const Inliers inliers = sum_inliers(pairs, state, prior, noise_m);
  StateMatrix of_prior = StateMatrix::Zero();
  of_prior.diagonal() = inverse_sigmas(prior).cwiseAbs2();
  const StateMatrix gain = (inliers.information + of_prior).inverse();
  const double pairs_per_independent_pair = prior.pair_sigma_m ? 1 : kPairsPerIndependentPair;
  const double noise_factor = pairs_per_independent_pair * kCauchyVariance * std::pow(prior.pair_error_factor, 2);
  const StateMatrix error =
      noise_factor * inliers.information + shared_errors(inliers.cells, state.head<2>(), prior) + of_prior;
  const StateMatrix covariance = gain * error * gain;
  return (covariance + covariance.transpose()) / 2;
}

/// Joins what the frame says with the prior position, each by its covariance.
void add_position_prior(const PosePrior& prior, const Eigen::Vector2d& prior_position_m, State& state,
                        StateMatrix& covariance) {
  const Eigen::Matrix<double, kUnknowns, 2> with_position = covariance.leftCols<2>();
  const Eigen::Matrix2d innovation_m2 = covariance.topLeftCorner<2, 2>() + prior.position_covariance_m2;
  const Eigen::Matrix<double, kUnknowns, 2> gain = with_position * innovation_m2.inverse();
  state += gain * (prior_position_m - state.head<2>());
  covariance -= gain * with_position.transpose();
  covariance = ((covariance + covariance.transpose()) / 2).eval();
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
  const std::size_t least_pairs = prior.pair_sigma_m ? 2 : 4;
  if (pairs.size() < least_pairs) return pose;
  State state = State::Zero();
  state.head<2>() = start_m;
  PoseResiduals residuals{&pairs, inverse_sigmas(prior), prior.pair_sigma_m.value_or(std::max(1.0, floor_m))};
  // The noise is not known before the fit, nor the fit without the noise.
  for (int round = 0; round < 2; ++round) {
    state = solve_state(residuals, state);
    if (!state.allFinite()) return pose;
    if (!prior.pair_sigma_m) residuals.noise_m = noise_from_median(errors_m(pairs, state), floor_m);
  }
  const std::vector<double> errors = errors_m(pairs, state);
  double sum_m2 = 0;
  for (const double error : errors) {
    if (!(error <= 3 * residuals.noise_m)) continue;
    ++pose.inliers;
    sum_m2 += error * error;
  }
  if (pose.inliers < static_cast<int>(least_pairs)) return pose;
  pose.covariance = frame_covariance(pairs, state, prior, residuals.noise_m);
  add_position_prior(prior, prior_position_m, state, pose.covariance);
  pose.position_m = state.head<2>();
  pose.tilt_rad = state.segment<2>(2);
  pose.turn_rad = state(4);
  pose.log_height = state(5);
  pose.residual_m = std::sqrt(sum_m2 / (2 * pose.inliers));
  pose.converged = pose.covariance.allFinite();
  return pose;
}

}  // namespace pilotage
