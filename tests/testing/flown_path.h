#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pilotage/base/angle.h"
#include "pilotage/base/random.h"
#include "pilotage/geo/ecef.h"
#include "pilotage/ins/ins_error_model.h"
#include "pilotage/navigate/strapdown.h"

namespace pilotage {

/// A flight in closed form, and what an ideal IMU counts on it: the truth that a mechanisation is held against. Written
/// from the derivatives of the path and of the attitude's angles, not from any mechanisation. Level over the tangent
/// plane of its start, at constant speed, with smooth coordinated turns; on request with a coning vibration.
class FlownPath {
 public:
  struct Turn {
    double start_s;
    double lasts_s;
    double angle_deg;
  };

  FlownPath(GeodeticPoint start, double speed_mps, double heading_deg, std::vector<Turn> turns = {},
            double vibration_deg = 0)
      : start_(start),
        speed_mps_(speed_mps),
        heading_rad_(heading_deg * kRadPerDeg),
        turns_(std::move(turns)),
        vibration_rad_(vibration_deg * kRadPerDeg),
        ecef_from_enu_(enu_from_ecef(start).transpose()),
        origin_m_(ecef_from_geodetic(start, kHeight_m)) {}

  static constexpr double kHeight_m = 300;

  /// The truth at the time that fly() has come to.
  InertialState state() const {
    InertialState state;
    state.time_s = time_s_;
    state.position_m = origin_m_ + ecef_from_enu_ * offset_m_;
    state.velocity_mps = ecef_from_enu_ * velocity_enu(time_s_);
    state.ecef_from_body = Eigen::Quaterniond(ecef_from_enu_ * enu_from_body(time_s_)).normalized();
    return state;
  }

  double heading_deg() const { return heading(time_s_)[0] / kRadPerDeg; }

  /// Flies on and returns what an IMU without errors counts meanwhile: Gauss-Legendre with four nodes.
  ImuIncrement fly(double dt_s) {
    constexpr std::array<double, 4> kNodes = {0.06943184420297371, 0.33000947820757187, 0.6699905217924281,
                                              0.9305681557970263};
    constexpr std::array<double, 4> kWeights = {0.17392742256872692, 0.3260725774312731, 0.3260725774312731,
                                                0.17392742256872692};
    ImuIncrement sum;
    sum.dt_s = dt_s;
    Eigen::Vector3d way_m = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      const double t_s = time_s_ + kNodes[i] * dt_s;
      const double weight_s = kWeights[i] * dt_s;
      const Eigen::Matrix3d body_from_ecef = (ecef_from_enu_ * enu_from_body(t_s)).transpose();
      const Eigen::Vector3d earth_radps(0, 0, kEarthRate_radps);
      // Within a step the place hardly matters for gravity.
      const Eigen::Vector3d place_m =
          origin_m_ + ecef_from_enu_ * (offset_m_ + velocity_enu(time_s_) * kNodes[i] * dt_s);
      const Eigen::Vector3d force = ecef_from_enu_ * acceleration_enu(t_s) - gravity_mps2(place_m) +
                                    2 * earth_radps.cross(ecef_from_enu_ * velocity_enu(t_s));
      sum.angle_rad += weight_s * (body_rate(t_s) + body_from_ecef * earth_radps);
      sum.velocity_mps += weight_s * (body_from_ecef * force);
      way_m += weight_s * velocity_enu(t_s);
    }
    offset_m_ += way_m;
    time_s_ += dt_s;
    return sum;
  }

 private:
  using Motion = std::array<double, 3>;  // a value and its first two derivatives

  Motion heading(double t_s) const {
    Motion h = {heading_rad_, 0, 0};
    for (const Turn& turn : turns_) {
      const double x = std::clamp((t_s - turn.start_s) / turn.lasts_s, 0.0, 1.0);
      const double angle = turn.angle_deg * kRadPerDeg;
      h[0] += angle * x * x * x * (10 - 15 * x + 6 * x * x);
      h[1] += angle * 30 * x * x * (1 - x) * (1 - x) / turn.lasts_s;
      h[2] += angle * 60 * x * (1 - x) * (1 - 2 * x) / (turn.lasts_s * turn.lasts_s);
    }
    return h;
  }
  // Coning: roll and pitch a quarter of a period apart, 4 times a second.
  Motion roll(double t_s) const {
    const Motion h = heading(t_s);
    const double slope = speed_mps_ * h[1] / 9.80665;
    return {std::atan(slope) + vibration_rad_ * std::sin(kVibration_radps * t_s),
            speed_mps_ * h[2] / 9.80665 / (1 + slope * slope) +
                vibration_rad_ * kVibration_radps * std::cos(kVibration_radps * t_s),
            0};
  }
  Motion pitch(double t_s) const {
    return {0.03 + vibration_rad_ * std::cos(kVibration_radps * t_s),
            -vibration_rad_ * kVibration_radps * std::sin(kVibration_radps * t_s), 0};
  }

  Eigen::Vector3d velocity_enu(double t_s) const {
    const double h = heading(t_s)[0];
    return speed_mps_ * Eigen::Vector3d(std::sin(h), std::cos(h), 0);
  }
  Eigen::Vector3d acceleration_enu(double t_s) const {
    const Motion h = heading(t_s);
    return speed_mps_ * h[1] * Eigen::Vector3d(std::cos(h[0]), -std::sin(h[0]), 0);
  }
  Eigen::Matrix3d enu_from_body(double t_s) const {
    Eigen::Matrix3d enu_from_ned;
    enu_from_ned << 0, 1, 0, 1, 0, 0, 0, 0, -1;
    return enu_from_ned * Eigen::Matrix3d(Eigen::AngleAxisd(heading(t_s)[0], Eigen::Vector3d::UnitZ()) *
                                          Eigen::AngleAxisd(pitch(t_s)[0], Eigen::Vector3d::UnitY()) *
                                          Eigen::AngleAxisd(roll(t_s)[0], Eigen::Vector3d::UnitX()));
  }
  /// Of the body against north, east, down (Groves, eq. 2.57).
  Eigen::Vector3d body_rate(double t_s) const {
    const Motion r = roll(t_s);
    const Motion p = pitch(t_s);
    const double yaw_rate = heading(t_s)[1];
    return {r[1] - std::sin(p[0]) * yaw_rate, std::cos(r[0]) * p[1] + std::sin(r[0]) * std::cos(p[0]) * yaw_rate,
            -std::sin(r[0]) * p[1] + std::cos(r[0]) * std::cos(p[0]) * yaw_rate};
  }

  static constexpr double kVibration_radps = 2 * 3.141592653589793 * 4;
  GeodeticPoint start_;
  double speed_mps_;
  double heading_rad_;
  std::vector<Turn> turns_;
  double vibration_rad_;
  Eigen::Matrix3d ecef_from_enu_;
  Eigen::Vector3d origin_m_;
  double time_s_ = 0;
  Eigen::Vector3d offset_m_ = Eigen::Vector3d::Zero();
};

inline Eigen::Vector3d normal_vector(Random& random) {
  return {random.normal(), random.normal(), random.normal()};
}

/// A first-order Gauss-Markov process that stands at its standard deviation; correlation 0: a constant.
template <int kSize>
struct SlowError {
  SlowError(double sigma_of_it, double correlation_of_it, Random& random)
      : sigma(sigma_of_it), correlation(correlation_of_it) {
    for (int i = 0; i < kSize; ++i) value[i] = sigma * random.normal();
  }
  void go_on(double by, Random& random) {
    if (!(correlation > 0)) return;
    const double decay = std::exp(-by / correlation);
    for (int i = 0; i < kSize; ++i)
      value[i] = decay * value[i] + sigma * std::sqrt(1 - decay * decay) * random.normal();
  }
  double sigma;
  double correlation;
  Eigen::Matrix<double, kSize, 1> value;
};

/// An IMU with the errors of a model (ins/ins_error_model.h), drawn once.
class SimulatedImu {
 public:
  SimulatedImu(const InsErrorModel& model, Random& random)
      : model_(model),
        random_(random),
        gyro_bias_(model.gyro_bias_radps, model.bias_correlation_s, random),
        accel_bias_(model.accel_bias_mps2, model.bias_correlation_s, random),
        gyro_scale_(model.gyro_scale * normal_vector(random)),
        accel_scale_(model.accel_scale * normal_vector(random)) {}

  ImuIncrement measure(const ImuIncrement& truth) {
    ImuIncrement out = truth;
    const double root_s = std::sqrt(truth.dt_s);
    out.angle_rad += gyro_scale_.cwiseProduct(truth.angle_rad) + gyro_bias_.value * truth.dt_s +
                     model_.angle_random_walk_rad_rt_s * root_s * normal_vector(random_);
    out.velocity_mps += accel_scale_.cwiseProduct(truth.velocity_mps) + accel_bias_.value * truth.dt_s +
                        model_.velocity_random_walk_mps_rt_s * root_s * normal_vector(random_);
    gyro_bias_.go_on(truth.dt_s, random_);
    accel_bias_.go_on(truth.dt_s, random_);
    return out;
  }

  const Eigen::Vector3d& gyro_bias_radps() const { return gyro_bias_.value; }
  const Eigen::Vector3d& accel_bias_mps2() const { return accel_bias_.value; }
  const Eigen::Vector3d& gyro_scale() const { return gyro_scale_; }
  const Eigen::Vector3d& accel_scale() const { return accel_scale_; }

 private:
  InsErrorModel model_;
  Random& random_;
  SlowError<3> gyro_bias_;
  SlowError<3> accel_bias_;
  Eigen::Vector3d gyro_scale_;
  Eigen::Vector3d accel_scale_;
};

/// A start that is as wrong as the model says (estimated minus true, uncorrelated, on every axis).
inline InertialState wrong_start(const InertialState& truth, const InsErrorModel& model, Random& random) {
  const Eigen::Matrix3d to_enu = enu_from_ecef(geodetic_from_ecef(truth.position_m));
  InertialState state = truth;
  state.position_m += model.start_sigma_m * normal_vector(random);
  state.velocity_mps += model.start_velocity_sigma_mps * normal_vector(random);
  const Eigen::Vector3d lean = normal_vector(random).cwiseProduct(
      Eigen::Vector3d(model.start_tilt_sigma_rad, model.start_tilt_sigma_rad, model.start_heading_sigma_rad));
  const Eigen::Vector3d turn = to_enu.transpose() * lean;
  if (turn.norm() > 0) {
    state.ecef_from_body = Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * state.ecef_from_body;
  }
  return state;
}

}  // namespace pilotage
