#include "pilotage/flightlog/drifting_priors.h"

#include <cmath>

#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/ins/ins_state.h"

namespace pilotage {
namespace {

constexpr double kGravity_mps2 = 9.80665;
constexpr double kEarthRadius_m = 6371000;
constexpr double kStep_s = 0.05;

Eigen::Vector2d normal_2d(Random& random) {
  const double first = random.normal();
  return {first, random.normal()};
}

/// Forward and right as columns.
Eigen::Matrix2d enu_from_body(double heading_deg) {
  const double sine = std::sin(heading_deg * kRadPerDeg);
  const double cosine = std::cos(heading_deg * kRadPerDeg);
  Eigen::Matrix2d matrix;
  matrix << sine, cosine, cosine, -sine;
  return matrix;
}

/// The errors of one flight.
struct DrawnErrors {
  Eigen::Vector2d position, velocity, tilt, accel_bias, gyro_bias;
  double heading = 0, vertical_gyro_bias = 0, accel_scale = 0, gyro_scale = 0;
};

DrawnErrors draw_errors(const InsErrorModel& model, Random& random) {
  DrawnErrors errors;
  errors.position = model.start_sigma_m * normal_2d(random);
  errors.velocity = model.start_velocity_sigma_mps * normal_2d(random);
  errors.tilt = model.start_tilt_sigma_rad * normal_2d(random);
  errors.accel_bias = model.accel_bias_mps2 * normal_2d(random);
  errors.gyro_bias = model.gyro_bias_radps * normal_2d(random);
  errors.heading = model.start_heading_sigma_rad * random.normal();
  errors.vertical_gyro_bias = model.gyro_bias_radps * random.normal();
  errors.accel_scale = model.accel_scale * random.normal();
  errors.gyro_scale = model.gyro_scale * random.normal();
  return errors;
}

/// A turn at one instant.
void turn(DrawnErrors& errors, double from_deg, double to_deg, double speed_mps) {
  const double turn_rad = std::remainder(to_deg - from_deg, 360.0) * kRadPerDeg;
  const Eigen::Vector2d change = speed_mps * (enu_from_body(to_deg).col(0) - enu_from_body(from_deg).col(0));
  const double lag = errors.heading + errors.gyro_scale * turn_rad / 2;
  errors.velocity += errors.accel_scale * change + lag * Eigen::Vector2d(change.y(), -change.x());
  errors.heading += errors.gyro_scale * turn_rad;
}

void fly_on(DrawnErrors& errors, double dt_s, double heading_deg, const InsErrorModel& model, Random& random) {
  const Eigen::Matrix2d body = enu_from_body(heading_deg);
  const double walk = std::sqrt(dt_s);
  const double keep = model.bias_correlation_s > 0 ? std::exp(-dt_s / model.bias_correlation_s) : 1;
  const double renew = std::sqrt(1 - keep * keep);
  const Eigen::Vector2d acceleration = kGravity_mps2 * errors.tilt + body * errors.accel_bias;
  errors.position += errors.velocity * dt_s + acceleration * dt_s * dt_s / 2;
  errors.tilt += (body * errors.gyro_bias - errors.velocity / kEarthRadius_m) * dt_s +
                 model.angle_random_walk_rad_rt_s * walk * normal_2d(random);
  errors.velocity += acceleration * dt_s + model.velocity_random_walk_mps_rt_s * walk * normal_2d(random);
  errors.heading += errors.vertical_gyro_bias * dt_s + model.angle_random_walk_rad_rt_s * walk * random.normal();
  errors.accel_bias = keep * errors.accel_bias + renew * model.accel_bias_mps2 * normal_2d(random);
  errors.gyro_bias = keep * errors.gyro_bias + renew * model.gyro_bias_radps * normal_2d(random);
  errors.vertical_gyro_bias = keep * errors.vertical_gyro_bias + renew * model.gyro_bias_radps * random.normal();
}

}  // namespace

std::vector<DriftingPrior> drifting_priors(const std::vector<FlownPlace>& places, double speed_mps,
                                           const InsErrorModel& model, std::uint64_t seed) {
  if (model.is_odometry() || model.velocity_aid_sigma_mps > 0) {
    throw UsageError(
        "drifting priors are those of an inertial system by itself: leave odometry and aiding velocity out");
  }
  std::vector<DriftingPrior> priors;
  if (places.empty()) return priors;
  Random random(derive_seed(seed, places.size()));
  DrawnErrors errors = draw_errors(model, random);
  InsState state = initial_ins_state(model, places.front().heading_deg, speed_mps);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const FlownPlace& before = places[i == 0 ? 0 : i - 1];
    const double flown_s = places[i].time_s - before.time_s;
    if (!(flown_s >= 0)) throw UsageError("place " + std::to_string(i) + " lies before the one before it in time");
    const double steps = std::ceil(flown_s / kStep_s);
    turn(errors, before.heading_deg, places[i].heading_deg, speed_mps);
    for (double step = 0; step < steps; ++step) fly_on(errors, flown_s / steps, places[i].heading_deg, model, random);
    state = propagate(state, flown_s, places[i].heading_deg, speed_mps, model);
    priors.push_back({errors.position, state.covariance.topLeftCorner<2, 2>()});
  }
  return priors;
}

}  // namespace pilotage
