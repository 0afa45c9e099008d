#include "pilotage/ins/ins_state.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Dense>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr double kGravity_mps2 = 9.80665;
constexpr double kEarthRadius_m = 6371000;
/// Longest step of the series below, in seconds and in correlation times; the terms left out are then below 1e-9 of the
/// result.
constexpr double kMaxStep_s = 10;
constexpr double kMaxStepOfCorrelation = 0.1;
/// Longest step between two uses of the aiding velocity.
constexpr double kAidStep_s = 0.5;

using enum InsState::Index;
using Matrix = InsState::Covariance;

/// Columns: forward and right of a heading, in east-north.
Eigen::Matrix2d enu_from_body(double heading_deg) {
  const double s = std::sin(heading_deg * kRadPerDeg);
  const double c = std::cos(heading_deg * kRadPerDeg);
  return (Eigen::Matrix2d() << s, c, c, -s).finished();
}

constexpr int kDriven = InsStep::kDriven;
constexpr int kDriving = InsStep::kDriving;

/// d(error)/dt = F · error for constant heading and speed. The map's error, which no state drives and which drives
/// none, is not in it.
Matrix system_matrix(const InsErrorModel& model, double heading_deg, double speed_mps) {
  const Eigen::Matrix2d rotation = enu_from_body(heading_deg);
  const double decay = model.bias_correlation_s > 0 ? -1 / model.bias_correlation_s : 0;
  Matrix f = Matrix::Zero();
  if (model.is_odometry()) {
    // The odometer's velocity is off by a fraction along and across the track, and turned by the heading error.
    f.block<2, 2>(kPosition, kAid) = speed_mps * rotation;
    f.block<2, 1>(kPosition, kHeading) = speed_mps * rotation.col(1);
  } else {
    f.block<2, 2>(kPosition, kVelocity).setIdentity();
    f.block<2, 2>(kVelocity, kTilt) = kGravity_mps2 * Eigen::Matrix2d::Identity();
    f.block<2, 2>(kVelocity, kAccelBias) = rotation;
    f.block<2, 2>(kTilt, kVelocity) = -Eigen::Matrix2d::Identity() / kEarthRadius_m;  // Schuler feedback
    if (model.velocity_aid_sigma_mps > 0) {
      f.block<2, 2>(kAid, kAid).diagonal().setConstant(-1 / model.velocity_aid_correlation_s);
    }
  }
  f.block<2, 2>(kTilt, kGyroBias) = rotation;
  f(kHeading, kGyroBiasZ) = 1;
  for (int i = kAccelBias; i <= kGyroBiasZ; ++i) f(i, i) = decay;
  return f;
}

using Vector = Eigen::Matrix<double, InsState::kSize, 1>;

/// Spectral densities of the white noise that drives each state.
Vector noise_density(const InsErrorModel& model) {
  const auto square = [](double x) { return x * x; };
  Vector q = Vector::Zero();
  if (!model.is_odometry()) {
    q.segment<2>(kVelocity).setConstant(square(model.velocity_random_walk_mps_rt_s));
    q.segment<2>(kAid).setConstant(2 * square(model.velocity_aid_sigma_mps) / model.velocity_aid_correlation_s);
  }
  q.segment<3>(kTilt).setConstant(square(model.angle_random_walk_rad_rt_s));
  if (model.bias_correlation_s > 0) {
    // A first-order Gauss-Markov process that starts, and stays, at its standard deviation.
    q.segment<2>(kAccelBias).setConstant(2 * square(model.accel_bias_mps2) / model.bias_correlation_s);
    q.segment<3>(kGyroBias).setConstant(2 * square(model.gyro_bias_radps) / model.bias_correlation_s);
  }
  return q;
}

/// exp(F t) by its series. The chains bias → tilt → velocity → position end after four factors; what remains are the
/// Schuler loop (ω t ≤ 0.013) and the decay of the biases, both small for t ≤ kMaxStep_s.
class Transition {
 public:
  explicit Transition(const Matrix& f) {
    powers_[0] = f;
    for (std::size_t k = 1; k < powers_.size(); ++k) powers_[k].setZero();
    std::vector<InsStep::Entry> driving;  // most of F is 0
    for (int col = 0; col < InsState::kSize; ++col) {
      for (int row = 0; row < InsState::kSize; ++row) {
        if (f(row, col) != 0) driving.push_back({row, col, f(row, col)});
      }
    }
    for (std::size_t k = 1; k < powers_.size(); ++k) {
      for (const InsStep::Entry& e : driving) powers_[k].col(e.col) += e.value * powers_[k - 1].col(e.row);
    }
  }

  Matrix at(double t_s) const {
    Matrix phi = Matrix::Identity();
    double factor = 1;
    for (std::size_t k = 0; k < powers_.size(); ++k) {
      factor *= t_s / static_cast<double>(k + 1);
      phi += factor * powers_[k];
    }
    return phi;
  }

 private:
  std::array<Matrix, 8> powers_;
};

/// ∫ Φ(s) Q Φ(s)ᵀ ds from 0 to dt by Gauss-Legendre with four nodes: exact for polynomials of degree 7, and the longest
/// chain of the noise (bias → tilt → velocity → position) has degree 6.
Matrix step_noise(const Transition& transition, const Vector& q, double dt_s) {
  constexpr std::array<double, 4> kNodes = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281,
                                            0.9305681557970263};
  constexpr std::array<double, 4> kWeights = {0.17392742256872692, 0.3260725774312731, 0.3260725774312731,
                                              0.17392742256872692};
  Matrix sum = Matrix::Zero();
  for (std::size_t i = 0; i < kNodes.size(); ++i) {
    const Matrix partial = transition.at(kNodes[i] * dt_s);
    for (int k = 0; k < InsState::kSize; ++k) {
      if (q(k) == 0) continue;
      const Vector driven = std::sqrt(kWeights[i] * dt_s * q(k)) * partial.col(k);
      sum += driven.lazyProduct(driven.transpose());
    }
  }
  return sum;
}

/// The longest step for which the series holds.
double longest_step_s(const InsErrorModel& model, bool aided) {
  double step_s = aided ? kAidStep_s : kMaxStep_s;
  if (model.bias_correlation_s > 0) step_s = std::min(step_s, kMaxStepOfCorrelation * model.bias_correlation_s);
  if (aided) step_s = std::min(step_s, kMaxStepOfCorrelation * model.velocity_aid_correlation_s);
  return step_s;
}

/// A measurement of the combination `h` of the errors that leaves it with the variance `most`; nothing where it has no
/// more. With the variance v before, its noise is most v / (v − most). Joseph form, one rank at a time: after an hour
/// without GNSS v may be 10¹² times what is left of it.
void hold(Matrix& covariance, const Vector& h, double most) {
  const Vector ph = covariance * h;
  const double variance = h.dot(ph);
  if (!(variance > most)) return;
  const Vector gain = (variance - most) / (variance * variance) * ph;
  Matrix next = covariance - gain * ph.transpose();
  next -= (next * h).eval() * gain.transpose();
  next += most * variance / (variance - most) * gain * gain.transpose();
  covariance = 0.5 * (next + next.transpose());
}

/// The same for both axes of the error ellipse of two states. Along its axes the two errors are uncorrelated, so the
/// second update does not move the first.
void hold_ellipse(Matrix& covariance, int first, double most) {
  const Eigen::Matrix2d ellipse = covariance.block<2, 2>(first, first);
  const double angle_rad = 0.5 * std::atan2(2 * ellipse(0, 1), ellipse(0, 0) - ellipse(1, 1));
  for (const Eigen::Vector2d& axis : {Eigen::Vector2d(std::cos(angle_rad), std::sin(angle_rad)),
                                      Eigen::Vector2d(-std::sin(angle_rad), std::cos(angle_rad))}) {
    Vector h = Vector::Zero();
    h.segment<2>(first) = axis;
    hold(covariance, h, most);
  }
}

double largest_variance(const Eigen::Matrix2d& covariance) {
  const double mean = 0.5 * (covariance(0, 0) + covariance(1, 1));
  const double apart = 0.5 * (covariance(0, 0) - covariance(1, 1));
  return mean + std::sqrt(apart * apart + covariance(0, 1) * covariance(0, 1));
}

}  // namespace

Matrix manoeuvre_jump(double from_heading_deg, double from_speed_mps, double heading_deg, double speed_mps,
                      bool odometry) {
  const double turn_rad = std::remainder(heading_deg - from_heading_deg, 360.0) * kRadPerDeg;
  Matrix jump = Matrix::Identity();
  jump(kHeading, kGyroScale) = turn_rad;
  if (odometry) return jump;
  const Eigen::Vector2d change_mps =
      enu_from_body(heading_deg).col(0) * speed_mps - enu_from_body(from_heading_deg).col(0) * from_speed_mps;
  jump.block<2, 1>(kVelocity, kAccelScale) = change_mps;
  // The acceleration is resolved along axes turned clockwise by the heading error (half of the turn's own share).
  const Eigen::Vector2d turned(change_mps.y(), -change_mps.x());
  jump.block<2, 1>(kVelocity, kHeading) = turned;
  jump.block<2, 1>(kVelocity, kGyroScale) = 0.5 * turn_rad * turned;
  return jump;
}

void manoeuvre(InsState& state, double heading_deg, double speed_mps, bool odometry, InsEstimate::Errors* errors) {
  if (heading_deg == state.heading_deg && speed_mps == state.speed_mps) return;
  const Matrix jump = manoeuvre_jump(state.heading_deg, state.speed_mps, heading_deg, speed_mps, odometry);
  if (errors != nullptr) *errors = (jump * *errors).eval();
  state.covariance = (jump * state.covariance * jump.transpose()).eval();
  state.heading_deg = heading_deg;
  state.speed_mps = speed_mps;
}

InsState initial_ins_state(const InsErrorModel& model, double heading_deg, double speed_mps) {
  const auto square = [](double x) { return x * x; };
  InsState state;
  state.heading_deg = heading_deg;
  state.speed_mps = speed_mps;
  Matrix& p = state.covariance;
  p.block<2, 2>(kPosition, kPosition).diagonal().setConstant(square(model.start_sigma_m));
  p.block<2, 2>(kTilt, kTilt).diagonal().setConstant(square(model.start_tilt_sigma_rad));
  p(kHeading, kHeading) = square(model.start_heading_sigma_rad);
  p.block<3, 3>(kGyroBias, kGyroBias).diagonal().setConstant(square(model.gyro_bias_radps));
  p(kGyroScale, kGyroScale) = square(model.gyro_scale);
  p.block<2, 2>(kMap, kMap).diagonal().setConstant(square(model.map_sigma_m));
  if (model.is_odometry()) {
    // Radial rms = drift: each of the two axes takes half of the variance.
    p.block<2, 2>(kAid, kAid).diagonal().setConstant(square(model.odometry_drift) / 2);
    return state;
  }
  p.block<2, 2>(kVelocity, kVelocity).diagonal().setConstant(square(model.start_velocity_sigma_mps));
  p.block<2, 2>(kAccelBias, kAccelBias).diagonal().setConstant(square(model.accel_bias_mps2));
  p(kAccelScale, kAccelScale) = square(model.accel_scale);
  p.block<2, 2>(kAid, kAid).diagonal().setConstant(square(model.velocity_aid_sigma_mps));
  return state;
}

InsStep make_ins_step(double dt_s, double heading_deg, double speed_mps, const InsErrorModel& model) {
  if (!(dt_s >= 0 && dt_s <= 1e6)) throw UsageError("dt_s = " + format_number(dt_s) + " is outside [0, 1e6]");
  if (!(speed_mps >= 0 && speed_mps <= 1e4)) {
    throw UsageError("speed_mps = " + format_number(speed_mps) + " is outside [0, 1e4]");
  }
  if (!std::isfinite(heading_deg)) throw UsageError("heading_deg is not finite");
  InsStep step;
  step.dt_s = dt_s;
  step.heading_deg = heading_deg;
  step.speed_mps = speed_mps;
  step.odometry = model.is_odometry();
  step.aided = !step.odometry && model.velocity_aid_sigma_mps > 0;
  if (dt_s == 0) return step;
  step.parts = std::ceil(dt_s / longest_step_s(model, step.aided));
  const double part_s = dt_s / step.parts;
  const Transition transition(system_matrix(model, heading_deg, speed_mps));
  step.phi = transition.at(part_s);
  step.noise = step_noise(transition, noise_density(model), part_s);
  if (model.map_sigma_m > 0) {
    // First-order Gauss-Markov along the way, exact for any length.
    const double decay = std::exp(-speed_mps * part_s / model.map_correlation_m);
    step.phi.block<2, 2>(kMap, kMap).diagonal().setConstant(decay);
    step.noise.block<2, 2>(kMap, kMap)
        .diagonal()
        .setConstant((1 - decay * decay) * model.map_sigma_m * model.map_sigma_m);
  }
  step.list_driving();
  return step;
}

void InsStep::list_driving() {
  driving.clear();
  for (int row = 0; row < kDriven; ++row) {
    for (int col = 0; col < InsState::kSize; ++col) {
      if (phi(row, col) != 0) driving.push_back({row, col, phi(row, col)});
    }
  }
}

Matrix covariance_after_part(const Matrix& covariance, const InsStep& step) {
  const Eigen::Matrix<double, kDriving, 1> decay = step.phi.diagonal().tail<kDriving>();
  // P Φᵀ, its first columns; most of Φ is 0.
  Eigen::Matrix<double, InsState::kSize, kDriven> half = Eigen::Matrix<double, InsState::kSize, kDriven>::Zero();
  for (const InsStep::Entry& e : step.driving) half.col(e.row) += e.value * covariance.col(e.col);
  Matrix grown;
  grown.topLeftCorner<kDriven, kDriven>().setZero();
  for (const InsStep::Entry& e : step.driving) {
    for (int i = 0; i <= e.row; ++i) grown(i, e.row) += e.value * half(e.col, i);
  }
  grown.topRightCorner<kDriven, kDriving>() = half.bottomRows<kDriving>().transpose() * decay.asDiagonal();
  grown.bottomRightCorner<kDriving, kDriving>() =
      decay.asDiagonal() * covariance.bottomRightCorner<kDriving, kDriving>() * decay.asDiagonal();
  for (int j = 0; j < InsState::kSize; ++j) {
    for (int i = 0; i <= j; ++i) grown(j, i) = grown(i, j) += step.noise(i, j);
  }
  return grown;
}

Eigen::Matrix<double, 2, InsState::kSize> fix_by_map() {
  Eigen::Matrix<double, 2, InsState::kSize> h = Eigen::Matrix<double, 2, InsState::kSize>::Zero();
  h.block<2, 2>(0, kPosition).setIdentity();
  h.block<2, 2>(0, kMap) = -Eigen::Matrix2d::Identity();
  return h;
}

Eigen::Matrix<double, InsState::kSize, 2> update_covariance(Matrix& covariance,
                                                            const Eigen::Matrix<double, 2, InsState::kSize>& h,
                                                            const Eigen::Matrix2d& noise) {
  using Columns = Eigen::Matrix<double, InsState::kSize, 2>;
  const Columns ph = covariance.lazyProduct(h.transpose());
  const Eigen::Matrix2d innovation = h.lazyProduct(ph) + noise;
  const Columns gain = innovation.ldlt().solve(ph.transpose()).transpose();
  covariance -= gain.lazyProduct(ph.transpose());
  const Columns left = covariance.lazyProduct(h.transpose());
  const Columns noisy = gain * noise - left;
  covariance += noisy.lazyProduct(gain.transpose());
  covariance = (0.5 * (covariance + covariance.transpose())).eval();
  return gain;
}

namespace {

/// Flies one step; `errors`, if not null, with it.
void fly(InsState& next, const InsStep& step, InsEstimate::Errors* errors) {
  manoeuvre(next, step.heading_deg, step.speed_mps, step.odometry, errors);
  Eigen::Matrix<double, 2, InsState::kSize> aid = Eigen::Matrix<double, 2, InsState::kSize>::Zero();
  aid.block<2, 2>(0, kVelocity).setIdentity();
  aid.block<2, 2>(0, kAid) = -Eigen::Matrix2d::Identity();
  for (double i = 0; i < step.parts; ++i) {
    next.covariance = covariance_after_part(next.covariance, step);
    if (errors != nullptr) *errors = (step.phi * *errors).eval();
    if (!step.aided) continue;
    const double variance = kVelocityAidNoise_mps_rt_hz * kVelocityAidNoise_mps_rt_hz * step.parts / step.dt_s;
    const auto gain = update_covariance(next.covariance, aid, variance * Eigen::Matrix2d::Identity());
    if (errors != nullptr) *errors -= (gain * (aid * *errors)).eval();  // the combination is 0
  }
  next.time_s += step.dt_s;
}

}  // namespace

InsState propagate(const InsState& state, const InsStep& step) {
  InsState next = state;
  fly(next, step, nullptr);
  return next;
}

InsEstimate propagate(const InsEstimate& estimate, const InsStep& step) {
  InsEstimate next = estimate;
  fly(next.state, step, &next.errors);
  return next;
}

InsEstimate update_with_position_error(const InsEstimate& estimate, const Eigen::Vector2d& measured_m,
                                       const Eigen::Matrix2d& covariance_m2) {
  Eigen::Matrix<double, 2, InsState::kSize> position = Eigen::Matrix<double, 2, InsState::kSize>::Zero();
  position.block<2, 2>(0, kPosition).setIdentity();
  InsEstimate next = estimate;
  const auto gain = update_covariance(next.state.covariance, position, covariance_m2);
  next.errors += gain * (measured_m - estimate.errors.segment<2>(kPosition));
  return next;
}

InsState propagate(const InsState& state, double dt_s, double heading_deg, double speed_mps,
                   const InsErrorModel& model) {
  return propagate(state, make_ins_step(dt_s, heading_deg, speed_mps, model));
}

InsState update_with_fix(const InsState& state, double fix_sigma_m) {
  if (!(fix_sigma_m > 0) || !std::isfinite(fix_sigma_m)) {
    throw UsageError("fix_sigma_m = " + format_number(fix_sigma_m) + " is not a positive length");
  }
  InsState next = state;
  update_covariance(next.covariance, fix_by_map(), fix_sigma_m * fix_sigma_m * Eigen::Matrix2d::Identity());
  return next;
}

InsState hold_with_gnss(const InsState& state, double heading_deg, double speed_mps, const InsErrorModel& model) {
  const auto square = [](double x) { return x * x; };
  InsState next = state;
  manoeuvre(next, heading_deg, speed_mps, model.is_odometry());
  hold_ellipse(next.covariance, kPosition, square(model.start_sigma_m));
  if (model.start_velocity_sigma_mps > 0) {
    hold_ellipse(next.covariance, kVelocity, square(model.start_velocity_sigma_mps));
  }
  if (model.start_tilt_sigma_rad > 0) hold_ellipse(next.covariance, kTilt, square(model.start_tilt_sigma_rad));
  if (model.start_heading_sigma_rad > 0) {
    hold(next.covariance, Vector::Unit(kHeading), square(model.start_heading_sigma_rad));
  }
  return next;
}

double position_error_m(const InsState& state, double sigma_multiple) {
  return position_error_m(state.covariance.block<2, 2>(kPosition, kPosition), sigma_multiple);
}

double position_error_m(const Eigen::Matrix2d& position_covariance_m2, double sigma_multiple) {
  return sigma_multiple * std::sqrt(largest_variance(position_covariance_m2));
}

AttitudeError attitude_error(const InsState& state, double sigma_multiple) {
  return {sigma_multiple * std::sqrt(largest_variance(state.covariance.block<2, 2>(kTilt, kTilt))),
          sigma_multiple * std::sqrt(state.covariance(kHeading, kHeading))};
}

}  // namespace pilotage
