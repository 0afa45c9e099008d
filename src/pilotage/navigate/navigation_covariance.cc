#include "pilotage/navigate/navigation_covariance.h"

#include <cmath>

#include "pilotage/geo/ecef.h"

namespace pilotage {
namespace {

using Errors = NavigationErrors;

/// Place, velocity and attitude, and what drives them: the biases and scale errors of the sensors.
constexpr int kInertial = 9;
constexpr int kSensors = 12;
static_assert(Errors::kGyroBias == kInertial && Errors::kBarometer == kInertial + kSensors);

double squared(double x) {
  return x * x;
}

Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// d gravity / d position: that of the point mass, whose radial part makes heights diverge and whose horizontal part
/// is the Schuler oscillation.
Eigen::Matrix3d gravity_gradient(const Eigen::Vector3d& position_m) {
  const double r = position_m.norm();
  const Eigen::Vector3d up = position_m / r;
  const double pull = gravity_mps2(position_m).norm() / r;
  return pull * (3 * up * up.transpose() - Eigen::Matrix3d::Identity());
}

struct Transition {
  Eigen::Matrix<double, kInertial, kInertial> of_inertial;
  Eigen::Matrix<double, kInertial, kSensors> of_sensors;
};

/// exp(∫F dt) to the third power; F's chain from an attitude's rate to the position has that many factors.
Transition transition_over(const FlownIntegrals& flown, const InertialState& state) {
  const Eigen::Matrix3d earth = cross_matrix({0, 0, kEarthRate_radps * flown.dt_s});
  Eigen::Matrix<double, kInertial, kInertial> m = Eigen::Matrix<double, kInertial, kInertial>::Zero();
  m.block<3, 3>(0, 3).diagonal().setConstant(flown.dt_s);
  m.block<3, 3>(3, 0) = gravity_gradient(state.position_m) * flown.dt_s;
  m.block<3, 3>(3, 3) = -2 * earth;
  m.block<3, 3>(3, 6) = -cross_matrix(flown.force_mps);
  m.block<3, 3>(6, 6) = -earth;
  Eigen::Matrix<double, kInertial, kSensors> b = Eigen::Matrix<double, kInertial, kSensors>::Zero();
  b.block<3, 3>(6, 0) = -flown.attitude_s;
  b.block<3, 3>(3, 3) = -flown.attitude_s;
  b.block<3, 3>(6, 6) = -flown.turned_rad;
  b.block<3, 3>(3, 9) = -flown.pushed_mps;
  Transition transition;
  transition.of_sensors = b;
  transition.of_sensors.noalias() += 0.5 * m * b;
  const Eigen::Matrix<double, kInertial, kInertial> m2 = m * m;
  transition.of_sensors.noalias() += m2 * b / 6;
  transition.of_inertial = Eigen::Matrix<double, kInertial, kInertial>::Identity() + m + 0.5 * m2;
  transition.of_inertial.noalias() += m2 * m / 6;
  return transition;
}

/// Of a first-order Gauss-Markov process over `share` correlation lengths.
double decay_over(double share) {
  return std::exp(-share);
}

/// Standing variance of each Gauss-Markov process.
Errors::Vector standing_variances(const InsErrorModel& model, const NavigationOptions& options) {
  Errors::Vector variance = Errors::Vector::Zero();
  variance.segment<3>(Errors::kGyroBias).setConstant(squared(model.gyro_bias_radps));
  variance.segment<3>(Errors::kAccelBias).setConstant(squared(model.accel_bias_mps2));
  variance.segment<3>(Errors::kGyroScale).setConstant(squared(model.gyro_scale));
  variance.segment<3>(Errors::kAccelScale).setConstant(squared(model.accel_scale));
  variance[Errors::kBarometer] = squared(options.barometer_sigma_m);
  variance.segment<2>(Errors::kMap).setConstant(squared(options.map_sigma_m));
  variance.segment<2>(Errors::kAid).setConstant(squared(model.velocity_aid_sigma_mps));
  return variance;
}

}  // namespace

Errors::Covariance initial_covariance(const InsErrorModel& model, const NavigationOptions& options,
                                      const InertialState& state) {
  Errors::Covariance covariance = standing_variances(model, options).asDiagonal();
  const Eigen::Matrix3d to_enu = enu_from_ecef(geodetic_from_ecef(state.position_m));
  const auto set = [&](int first, double horizontal, double vertical) {
    const Eigen::Vector3d variances(squared(horizontal), squared(horizontal), squared(vertical));
    covariance.block<3, 3>(first, first) = to_enu.transpose() * variances.asDiagonal() * to_enu;
  };
  set(Errors::kPosition, model.start_sigma_m, model.start_sigma_m);
  set(Errors::kVelocity, model.start_velocity_sigma_mps, model.start_velocity_sigma_mps);
  set(Errors::kAttitude, model.start_tilt_sigma_rad, model.start_heading_sigma_rad);
  return covariance;
}

Errors::Vector error_decays(const FlownIntegrals& flown, const InertialState& state, const InsErrorModel& model,
                            const NavigationOptions& options) {
  Errors::Vector decay = Errors::Vector::Ones();
  if (model.bias_correlation_s > 0) {
    decay.segment<6>(Errors::kGyroBias).setConstant(decay_over(flown.dt_s / model.bias_correlation_s));
  }
  decay[Errors::kBarometer] = decay_over(flown.dt_s / options.barometer_correlation_s);
  decay.segment<2>(Errors::kMap)
      .setConstant(decay_over(flown.dt_s * state.velocity_mps.norm() / options.map_correlation_m));
  decay.segment<2>(Errors::kAid).setConstant(decay_over(flown.dt_s / model.velocity_aid_correlation_s));
  return decay;
}

void propagate(Errors::Covariance& covariance, const FlownIntegrals& flown, const InertialState& state,
               const InsErrorModel& model, const NavigationOptions& options) {
  const Transition phi = transition_over(flown, state);
  const Errors::Vector decay = error_decays(flown, state, model, options);
  // The first rows of Φ P, then those of Φ P Φᵀ; the other errors only decay.
  Eigen::Matrix<double, kInertial, Errors::kSize> rows;
  rows.noalias() = phi.of_inertial * covariance.topRows<kInertial>();
  rows.noalias() += phi.of_sensors * covariance.middleRows<kSensors>(kInertial);
  Eigen::Matrix<double, kInertial, kInertial> inertial;
  inertial.noalias() = rows.leftCols<kInertial>() * phi.of_inertial.transpose();
  inertial.noalias() += rows.middleCols<kSensors>(kInertial) * phi.of_sensors.transpose();

  covariance = (decay.asDiagonal() * covariance * decay.asDiagonal()).eval();
  covariance.diagonal() += standing_variances(model, options).cwiseProduct(Errors::Vector::Ones() - decay.cwiseAbs2());
  covariance.topRows<kInertial>() = rows * decay.asDiagonal();

  // White noise of the sensors: ∫ Φ Q Φᵀ by the trapezoidal rule.
  Eigen::Matrix<double, kInertial, 1> noise = Eigen::Matrix<double, kInertial, 1>::Zero();
  noise.segment<3>(Errors::kVelocity).setConstant(squared(model.velocity_random_walk_mps_rt_s) * flown.dt_s / 2);
  noise.segment<3>(Errors::kAttitude).setConstant(squared(model.angle_random_walk_rad_rt_s) * flown.dt_s / 2);
  const Eigen::Matrix<double, kInertial, kInertial> scaled = phi.of_inertial * noise.asDiagonal();
  inertial.noalias() += scaled * phi.of_inertial.transpose();
  inertial.diagonal() += noise;
  covariance.topLeftCorner<kInertial, kInertial>() = 0.5 * (inertial + inertial.transpose());
  covariance.leftCols<kInertial>() = covariance.topRows<kInertial>().transpose().eval();
}

}  // namespace pilotage
