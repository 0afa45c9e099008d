#include "aircraft.h"

#include <algorithm>
#include <cmath>

#include "pilotage/base/angle.h"
#include "pilotage/geo/ecef.h"

namespace pilotage {
namespace {

constexpr double kMostAcceleration_mps2 = 4;
constexpr double kVelocityLag_s = 0.4;      // in which the velocity is to be the wanted one
constexpr double kAccelerationLag_s = 0.2;  // of thrust and attitude
constexpr double kFastestTurn_degps = 90;   // of the nose
constexpr double kFastestTilt_radps = 3;
constexpr double kAltitudeEach_s = 0.2;
constexpr double kAltimeterCorrelation_s = 60;

Eigen::Vector3d draw3(Random& random) {
  const double x = random.normal();
  const double y = random.normal();
  return {x, y, random.normal()};
}

NavigationOptions navigation_options(double map_sigma_m) {
  NavigationOptions options;
  options.map_sigma_m = map_sigma_m;
  options.barometer_sigma_m = kAltimeterSlow_m;
  options.barometer_noise_m = kAltimeterNoise_m;
  options.barometer_correlation_s = kAltimeterCorrelation_s;
  return options;
}

/// Believed minus true, along each axis as the model says.
InertialState wrong_by(const InertialState& truth, const InsErrorModel& model, const Eigen::Matrix3d& ecef_from_enu,
                       Random& random) {
  InertialState state = truth;
  state.position_m += model.start_sigma_m * draw3(random);
  state.velocity_mps += model.start_velocity_sigma_mps * draw3(random);
  const Eigen::Vector3d figures(model.start_tilt_sigma_rad, model.start_tilt_sigma_rad, model.start_heading_sigma_rad);
  const Eigen::Vector3d turn = ecef_from_enu * draw3(random).cwiseProduct(figures);
  if (turn.norm() > 0) {
    state.ecef_from_body = Eigen::Quaterniond(Eigen::AngleAxisd(turn.norm(), turn.normalized())) * state.ecef_from_body;
  }
  return state;
}

/// Belly against the thrust, nose as near to the heading as that lets it.
Eigen::Matrix3d attitude_for(const Eigen::Vector3d& thrust, double heading_deg) {
  const Eigen::Vector3d nose(std::sin(heading_deg * kRadPerDeg), std::cos(heading_deg * kRadPerDeg), 0);
  Eigen::Matrix3d enu_from_body;
  enu_from_body.col(2) = -thrust.normalized();
  enu_from_body.col(1) = enu_from_body.col(2).cross(nose).normalized();
  enu_from_body.col(0) = enu_from_body.col(1).cross(enu_from_body.col(2));
  return enu_from_body;
}

}  // namespace

Aircraft::Aircraft(GeodeticPoint middle, const InsErrorModel& model, double map_sigma_m, const Eigen::Vector3d& start,
                   double heading_deg, std::uint64_t seed)
    : middle_(middle),
      enu_from_ecef_(enu_from_ecef(middle)),
      origin_m_(ecef_from_geodetic(middle, 0)),
      model_(model),
      random_(derive_seed(seed, seed_from_name("aircraft"))),
      gyro_bias_radps_(model.gyro_bias_radps * draw3(random_)),
      accel_bias_mps2_(model.accel_bias_mps2 * draw3(random_)),
      gyro_scale_(model.gyro_scale * draw3(random_)),
      accel_scale_(model.accel_scale * draw3(random_)),
      altimeter_m_(kAltimeterSlow_m * random_.normal()),
      filter_([&] {
        truth_.position_m = origin_m_ + enu_from_ecef_.transpose() * start;
        const Eigen::Matrix3d level = attitude_for(Eigen::Vector3d::UnitZ(), heading_deg);
        truth_.ecef_from_body = Eigen::Quaterniond(enu_from_ecef_.transpose() * level).normalized();
        return NavigationFilter(model, navigation_options(map_sigma_m),
                                wrong_by(truth_, model, enu_from_ecef_.transpose(), random_));
      }()),
      heading_deg_(heading_deg) {}

FieldState Aircraft::on_field(const InertialState& state) const {
  return {enu_from_ecef_ * (state.position_m - origin_m_), enu_from_ecef_ * state.velocity_mps,
          enu_from_ecef_ * state.ecef_from_body.toRotationMatrix()};
}

/// What the IMU says: with its drawn biases, which wander, scale errors and noise.
ImuIncrement Aircraft::measured(const ImuIncrement& counted) {
  ImuIncrement out = counted;
  const double root_s = std::sqrt(counted.dt_s);
  out.angle_rad += gyro_scale_.cwiseProduct(counted.angle_rad) + gyro_bias_radps_ * counted.dt_s +
                   model_.angle_random_walk_rad_rt_s * root_s * draw3(random_);
  out.velocity_mps += accel_scale_.cwiseProduct(counted.velocity_mps) + accel_bias_mps2_ * counted.dt_s +
                      model_.velocity_random_walk_mps_rt_s * root_s * draw3(random_);
  if (model_.bias_correlation_s > 0) {
    const double decay = std::exp(-counted.dt_s / model_.bias_correlation_s);
    const double fresh = std::sqrt(1 - decay * decay);
    gyro_bias_radps_ = decay * gyro_bias_radps_ + fresh * model_.gyro_bias_radps * draw3(random_);
    accel_bias_mps2_ = decay * accel_bias_mps2_ + fresh * model_.accel_bias_mps2 * draw3(random_);
  }
  return out;
}

void Aircraft::fly(const Eigen::Vector3d& velocity_mps, double heading_deg) {
  const FieldState believed_now = believed();
  Eigen::Vector3d wanted = (velocity_mps - believed_now.velocity_mps) / kVelocityLag_s;
  if (wanted.norm() > kMostAcceleration_mps2) wanted *= kMostAcceleration_mps2 / wanted.norm();
  wanted_mps2_ += std::min(1.0, kStep_s / kAccelerationLag_s) * (wanted - wanted_mps2_);
  const double turn_deg = std::remainder(heading_deg - heading_deg_, 360.0);
  heading_deg_ += std::clamp(turn_deg, -kFastestTurn_degps * kStep_s, kFastestTurn_degps * kStep_s);

  const double gravity = gravity_mps2(truth_.position_m).norm();
  const Eigen::Vector3d thrust = wanted_mps2_ + gravity * Eigen::Vector3d::UnitZ();
  const Eigen::AngleAxisd turn(believed_now.enu_from_body.transpose() * attitude_for(thrust, heading_deg_));
  const double angle_rad = std::min(turn.angle(), kFastestTilt_radps * kStep_s);

  ImuIncrement counted;
  counted.dt_s = kStep_s;
  const Eigen::Vector3d earth_radps(0, 0, kEarthRate_radps);
  counted.angle_rad = angle_rad * turn.axis() + truth_.ecef_from_body.conjugate() * earth_radps * kStep_s;
  counted.velocity_mps = believed_now.enu_from_body.transpose() * thrust * kStep_s;
  truth_ = advance(truth_, counted, before_);
  before_ = counted;
  filter_.advance(measured(counted));

  if (++steps_ % static_cast<int>(std::lround(kAltitudeEach_s / kStep_s)) != 0) return;
  const double decay = std::exp(-kAltitudeEach_s / kAltimeterCorrelation_s);
  altimeter_m_ = decay * altimeter_m_ + std::sqrt(1 - decay * decay) * kAltimeterSlow_m * random_.normal();
  filter_.take_height(truth().position_m.z() + altimeter_m_ + kAltimeterNoise_m * random_.normal());
}

Eigen::Matrix<double, 6, 6> Aircraft::pose_covariance() {
  const NavigationErrors::Covariance& all = filter_.covariance();
  Eigen::Matrix<double, 6, NavigationErrors::kSize> pick = Eigen::Matrix<double, 6, NavigationErrors::kSize>::Zero();
  pick.block<3, 3>(0, NavigationErrors::kPosition) = enu_from_ecef_;
  pick.block<3, 3>(3, NavigationErrors::kAttitude) = enu_from_ecef_;
  const Eigen::Matrix<double, 6, 6> both = pick * all * pick.transpose();
  return 0.5 * (both + both.transpose());
}

}  // namespace pilotage
