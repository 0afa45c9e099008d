#include "pilotage/ins/ins_state.h"

#include <array>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

constexpr double kG = 9.80665;
const double kSchuler = std::sqrt(kG / 6371000);  // rad/s

/// A model without any error but a position known to 1e-9 m.
InsErrorModel nothing() {
  InsErrorModel model;
  model.start_sigma_m = 1e-9;
  return model;
}

double sigma_after(const InsErrorModel& model, double time_s, double heading_deg = 30, double speed_mps = 20) {
  return position_error_m(
      propagate(initial_ins_state(model, heading_deg, speed_mps), time_s, heading_deg, speed_mps, model), 1);
}

// Each single error grows by its own law (for times well below the 84-minute Schuler period).
/// √(σ_east² + σ_north²).
double position_drms_m(const InsState& state) {
  return std::sqrt(state.covariance(0, 0) + state.covariance(1, 1));
}

TEST(InsState, VelocityErrorGrowsWithTime) {
  InsErrorModel model = nothing();
  model.start_velocity_sigma_mps = 0.1;
  EXPECT_NEAR(sigma_after(model, 30) / (0.1 * 30), 1, 1e-3);
}

TEST(InsState, AccelerometerBiasGrowsWithTimeSquared) {
  InsErrorModel model = nothing();
  model.accel_bias_mps2 = 0.01;
  EXPECT_NEAR(sigma_after(model, 30) / (0.01 * 30 * 30 / 2), 1, 1e-3);
}

TEST(InsState, TiltGrowsWithTimeSquared) {
  InsErrorModel model = nothing();
  model.start_tilt_sigma_rad = 0.001;
  EXPECT_NEAR(sigma_after(model, 30) / (kG * 0.001 * 30 * 30 / 2), 1, 1e-3);
}

TEST(InsState, GyroBiasGrowsWithTimeCubed) {
  InsErrorModel model = nothing();
  model.gyro_bias_radps = 1e-5;
  EXPECT_NEAR(sigma_after(model, 30) / (kG * 1e-5 * 30 * 30 * 30 / 6), 1, 1e-3);
}

TEST(InsState, VelocityRandomWalkGrowsWithTimeToThreeHalves) {
  InsErrorModel model = nothing();
  model.velocity_random_walk_mps_rt_s = 0.002;
  EXPECT_NEAR(sigma_after(model, 30) / (0.002 * std::sqrt(30.0 * 30 * 30 / 3)), 1, 1e-3);
}

TEST(InsState, AngleRandomWalkGrowsWithTimeToFiveHalves) {
  InsErrorModel model = nothing();
  model.angle_random_walk_rad_rt_s = 1e-4;
  EXPECT_NEAR(sigma_after(model, 30) / (kG * 1e-4 * std::sqrt(std::pow(30.0, 5) / 20)), 1, 1e-3);
}

// Over a Schuler period the same errors oscillate: x = b (1 − cos ωt) / ω² and x = b g (t/ω² − sin(ωt)/ω³).
TEST(InsState, SchulerFeedbackBoundsTheAccelerometerBias) {
  for (const double time_s : {300.0, 1266.0, 2532.0, 5064.0}) {
    InsErrorModel model = nothing();
    model.accel_bias_mps2 = 0.01;
    const double expected = 0.01 * (1 - std::cos(kSchuler * time_s)) / (kSchuler * kSchuler);
    EXPECT_NEAR(sigma_after(model, time_s), expected, 1e-6 * 0.01 / (kSchuler * kSchuler)) << time_s;
    InsErrorModel gyro = nothing();
    gyro.gyro_bias_radps = 1e-6;
    const double expected_gyro =
        1e-6 * kG * (time_s / (kSchuler * kSchuler) - std::sin(kSchuler * time_s) / std::pow(kSchuler, 3));
    EXPECT_NEAR(sigma_after(gyro, time_s) / expected_gyro, 1, 1e-5) << time_s;
  }
}

InsErrorModel everything() {
  InsOptions options;
  options.grade = InsGrade::kIndustrial;
  return make_ins_error_model(options);
}

// Flying a time in one step or in many uneven ones is the same.
TEST(InsState, StepsCompose) {
  for (const double bias_correlation_s : {0.0, 7.0, 1000.0}) {
    InsErrorModel model = everything();
    model.bias_correlation_s = bias_correlation_s;
    const InsState start = initial_ins_state(model, 40, 20);
    const InsState once = propagate(start, 47, 40, 20, model);
    InsState many = start;
    for (const double dt_s : {0.01, 3.0, 0.5, 11.49, 30.0, 2.0}) many = propagate(many, dt_s, 40, 20, model);
    EXPECT_NEAR(once.time_s, many.time_s, 1e-9);
    const auto scale = once.covariance.diagonal().cwiseSqrt().cwiseMax(1e-30).eval();
    for (int i = 0; i < InsState::kSize; ++i) {
      for (int j = 0; j < InsState::kSize; ++j) {
        EXPECT_NEAR(once.covariance(i, j) / (scale(i) * scale(j)), many.covariance(i, j) / (scale(i) * scale(j)), 1e-8)
            << i << "," << j;
      }
    }
  }
}

// The result does not depend on where north is.
TEST(InsState, AStepWorkedOutOnceGivesTheSameBits) {
  for (const InsGrade grade : {InsGrade::kTactical, InsGrade::kVisualOdometry}) {
    InsOptions options;
    options.grade = grade;
    if (grade == InsGrade::kTactical) options.velocity_aid_sigma_mps = 1;
    const InsErrorModel model = make_ins_error_model(options);
    const InsState start = propagate(initial_ins_state(model, 10, 20), 7, 10, 20, model);
    const InsState direct = propagate(start, 33, 80, 25, model);
    const InsState stepped = propagate(start, make_ins_step(33, 80, 25, model));
    EXPECT_EQ(direct.covariance, stepped.covariance);
    EXPECT_EQ(direct.time_s, stepped.time_s);
    EXPECT_EQ(stepped.heading_deg, 80);
    EXPECT_EQ(stepped.speed_mps, 25);
  }
}

TEST(InsState, RotatesWithTheHeading) {
  const InsErrorModel model = everything();
  const auto fly = [&](double heading_deg) {
    InsState state = initial_ins_state(model, heading_deg, 20);
    state = propagate(state, 20, heading_deg, 20, model);
    state = propagate(state, 25, heading_deg + 90, 25, model);
    return state;
  };
  for (const double heading_deg : {17.0, 90.0, 359.0, -130.0}) {
    EXPECT_NEAR(position_error_m(fly(heading_deg), 3), position_error_m(fly(0), 3), 1e-9);
    EXPECT_NEAR(position_drms_m(fly(heading_deg)), position_drms_m(fly(0)), 1e-9);
  }
}

// A turn at speed v with heading error σ leaves a velocity error of σ·|Δv| across the change of velocity.
TEST(InsState, TurnsBringTheHeadingErrorIntoTheVelocity) {
  InsErrorModel model = nothing();
  model.start_heading_sigma_rad = 0.02;
  const InsState straight = propagate(initial_ins_state(model, 0, 30), 10, 0, 30, model);
  EXPECT_LT(position_error_m(straight, 1), 1e-6);
  const InsState turned = propagate(initial_ins_state(model, 0, 30), 10, 90, 30, model);
  EXPECT_NEAR(position_error_m(turned, 1), 0.02 * 30 * std::sqrt(2.0) * 10, 1e-2);
  // Δv points south-east, so the error lies along north-east.
  EXPECT_GT(turned.covariance(0, 1), 0);
}

TEST(InsState, ScaleErrorsCountInManoeuvresOnly) {
  InsErrorModel model = nothing();
  model.accel_scale = 0.001;
  EXPECT_LT(sigma_after(model, 60), 1e-6);
  const InsState faster = propagate(initial_ins_state(model, 0, 10), 20, 0, 30, model);
  EXPECT_NEAR(position_error_m(faster, 1), 0.001 * 20 * 20, 1e-3);
  InsErrorModel gyro = nothing();
  gyro.gyro_scale = 0.001;
  const InsState turned = propagate(initial_ins_state(gyro, 350, 0), 1, 80, 0, gyro);
  EXPECT_NEAR(attitude_error(turned, 1).heading_rad, 0.001 * M_PI / 2, 1e-9) << "the short way round";
}

TEST(InsState, VisualOdometryDriftsWithDistance) {
  InsErrorModel model = nothing();
  model.odometry_drift = 0.01;
  for (const double speed_mps : {5.0, 20.0}) {
    const InsState state = propagate(initial_ins_state(model, 70, speed_mps), 100, 70, speed_mps, model);
    EXPECT_NEAR(position_drms_m(state), 0.01 * 100 * speed_mps, 1e-6) << "radial rms is 1 % of the distance";
  }
  model.odometry_drift = 1e-6;
  model.gyro_bias_radps = 1e-4;
  const InsState state = propagate(initial_ins_state(model, 0, 10), 100, 0, 10, model);
  EXPECT_NEAR(std::sqrt(state.covariance(0, 0)), 10 * 1e-4 * 100 * 100 / 2, 1e-3) << "heading drift carries it east";
}

// An aiding velocity with a slow error of σ and correlation time τ bounds the drift: σ_x² = 2σ²τ (t − τ(1 − e^(−t/τ))).
TEST(InsState, AidingVelocityBoundsTheDrift) {
  InsErrorModel model = everything();
  model.accel_bias_mps2 = 10;  // an inertial sensor that is worth nothing
  model.velocity_random_walk_mps_rt_s = 10;
  model.start_velocity_sigma_mps = 10;
  model.velocity_aid_sigma_mps = 1;
  model.velocity_aid_correlation_s = 100;
  model.start_sigma_m = 1e-6;
  const double expected = std::sqrt(2 * 100 * (600 - 100 * (1 - std::exp(-6.0))));
  EXPECT_NEAR(sigma_after(model, 600) / expected, 1, 0.02);
  const InsErrorModel good = everything();
  InsErrorModel aided = good;
  aided.velocity_aid_sigma_mps = 1;
  EXPECT_LT(sigma_after(aided, 120), sigma_after(good, 120));
}

TEST(InsState, FixesTeachPositionThenVelocity) {
  const InsErrorModel model = everything();
  InsState state = propagate(initial_ins_state(model, 0, 20), 60, 0, 20, model);
  const double velocity_before = std::sqrt(state.covariance(2, 2));
  state = update_with_fix(state, 2);
  EXPECT_LT(position_error_m(state, 1), 2);
  EXPECT_GT(position_error_m(state, 1), 1.9);
  for (int i = 0; i < 4; ++i) state = update_with_fix(propagate(state, 5, 0, 20, model), 2);
  EXPECT_LT(std::sqrt(state.covariance(2, 2)), velocity_before / 3);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<InsState::Covariance>(state.covariance).eigenvalues().minCoeff(), -1e-12);
}

double smallest_eigenvalue(const InsState::Covariance& matrix) {
  return Eigen::SelfAdjointEigenSolver<InsState::Covariance>(matrix).eigenvalues().minCoeff();
}

TEST(InsState, GnssIsAMeasurementThatLeavesTheFiguresOfItsLoss) {
  InsErrorModel model = everything();
  const InsState before = propagate(initial_ins_state(model, 0, 20), 60, 0, 20, model);
  const double variance = before.covariance(0, 0);
  const double most = model.start_sigma_m * model.start_sigma_m;
  const InsState fixed = update_with_fix(before, std::sqrt(most * variance / (variance - most)));
  InsErrorModel position_alone = model;
  position_alone.start_velocity_sigma_mps = 0;
  position_alone.start_tilt_sigma_rad = 0;
  position_alone.start_heading_sigma_rad = 0;
  const InsState held = hold_with_gnss(before, 0, 20, position_alone);
  EXPECT_LT((held.covariance - fixed.covariance).norm(), 1e-9 * before.covariance.norm());
  EXPECT_GT(held.covariance(2, 2), 2 * model.start_velocity_sigma_mps * model.start_velocity_sigma_mps);

  // After a turn, so that the ellipses lie askew.
  const InsState turned = propagate(before, 60, 70, 20, model);
  const InsState all = hold_with_gnss(turned, 70, 20, model);
  EXPECT_LE(position_error_m(all, 1), model.start_sigma_m);
  EXPECT_GT(position_error_m(all, 1), 0.9 * model.start_sigma_m);
  EXPECT_LE(attitude_error(all, 1).tilt_rad, model.start_tilt_sigma_rad * (1 + 1e-9));
  EXPECT_LE(attitude_error(all, 1).heading_rad, model.start_heading_sigma_rad * (1 + 1e-9));
  EXPECT_GT(smallest_eigenvalue(turned.covariance - all.covariance), -1e-9) << "nothing becomes worse";
  EXPECT_GT(smallest_eigenvalue(all.covariance), -1e-12);
  EXPECT_LT((hold_with_gnss(all, 70, 20, model).covariance - all.covariance).norm(), 1e-12);
}

// A million metres off, and back to a centimetre.
TEST(InsState, GnssComesBackAfterAnHour) {
  InsOptions options;
  options.grade = InsGrade::kConsumer;
  options.start_sigma_m = 0.01;
  const InsErrorModel model = make_ins_error_model(options);
  InsState state = propagate(initial_ins_state(model, 30, 50), 3600, 30, 50, model);
  EXPECT_GT(position_error_m(state, 1), 1e5);
  state = hold_with_gnss(state, 200, 50, model);
  EXPECT_NEAR(position_error_m(state, 1), 0.01, 1e-4);
  EXPECT_LE(std::sqrt(state.covariance(2, 2)), model.start_velocity_sigma_mps * (1 + 1e-6));
  EXPECT_GT(smallest_eigenvalue(state.covariance), -1e-9);
  state = hold_with_gnss(propagate(state, 1, 200, 50, model), 200, 50, model);
  EXPECT_LE(position_error_m(state, 1), 0.01 * (1 + 1e-9));
}

// What is known better than at the loss of GNSS stays, and a start is what it was.
TEST(InsState, GnssTakesNothingAway) {
  const InsErrorModel model = everything();
  const InsState start = initial_ins_state(model, 40, 20);
  EXPECT_LT((hold_with_gnss(start, 40, 20, model).covariance - start.covariance).norm(), 1e-12);
  InsState known = update_with_fix(start, 0.5);
  for (int i = 0; i < 20; ++i) known = update_with_fix(propagate(known, 5, 40, 20, model), 0.5);
  const InsState held = hold_with_gnss(known, 40, 20, model);
  EXPECT_EQ((held.covariance.topLeftCorner<6, 6>()), (known.covariance.topLeftCorner<6, 6>()));
  EXPECT_LT(held.covariance(6, 6), known.covariance(6, 6))
      << "position fixes on a straight line say nothing of heading";
}

// A filter with a receiver whose velocity is off by 0.1 m/s each second and whose position by 3 m each 200 s, errors
// that are independent: worse than receivers are. Holding the errors must not claim more than such a filter knows.
TEST(InsState, GnssTeachesNoMoreThanAReceiverDoes) {
  for (const InsGrade grade :
       {InsGrade::kConsumer, InsGrade::kIndustrial, InsGrade::kTactical, InsGrade::kNavigation}) {
    InsOptions options;
    options.grade = grade;
    const InsErrorModel model = make_ins_error_model(options);
    InsState held = initial_ins_state(model, 90, 20);
    InsState aided = held;
    for (int t = 1; t <= 1800; ++t) {
      held = hold_with_gnss(propagate(held, 1, 90, 20, model), 90, 20, model);
      aided = propagate(aided, 1, 90, 20, model);
      const Eigen::Matrix2d innovation = aided.covariance.block<2, 2>(2, 2) + 0.01 * Eigen::Matrix2d::Identity();
      const Eigen::Matrix<double, InsState::kSize, 2> ph = aided.covariance.middleCols<2>(2);
      aided.covariance -= (ph * innovation.inverse() * ph.transpose()).eval();
      if (t % 200 == 0) aided = update_with_fix(aided, 3);
      if (t != 60 && t % 300 != 0) continue;
      // Velocity, tilt, biases of both axes, and what they do together over the next minute.
      for (const int i : {2, 3, 4, 5, 7, 8, 9, 10}) {
        EXPECT_GT(held.covariance(i, i), 0.98 * aided.covariance(i, i))
            << static_cast<int>(grade) << " " << t << " " << i;
      }
      InsState lost = aided;
      lost.covariance.topRows<2>().setZero();
      lost.covariance.leftCols<2>().setZero();
      lost.covariance.block<2, 2>(0, 0).diagonal().setConstant(9);
      EXPECT_GT(position_error_m(propagate(held, 60, 90, 20, model), 1),
                0.98 * position_error_m(propagate(lost, 60, 90, 20, model), 1));
    }
  }
}

TEST(InsState, ArgumentsAreChecked) {
  const InsErrorModel model = everything();
  const InsState state = initial_ins_state(model, 0, 20);
  EXPECT_THROW(propagate(state, -1, 0, 20, model), UsageError);
  EXPECT_THROW(propagate(state, NAN, 0, 20, model), UsageError);
  EXPECT_THROW(propagate(state, 1, INFINITY, 20, model), UsageError);
  EXPECT_THROW(propagate(state, 1, 0, -1, model), UsageError);
  EXPECT_THROW(update_with_fix(state, 0), UsageError);
  EXPECT_EQ(propagate(state, 0, 0, 20, model).covariance, state.covariance);
}

/// One flight with true random errors, integrated in small steps and written without the matrices of the library.
struct PositionError {
  double east_m, north_m;
};

PositionError simulate(const InsErrorModel& model, Random& random) {
  constexpr double kDt = 0.02;
  const double decay = std::exp(-kDt / model.bias_correlation_s);
  const double kick = std::sqrt(1 - decay * decay);
  const auto draw = [&](double sigma) { return sigma * random.normal(); };
  std::array<double, 2> position{draw(model.start_sigma_m), draw(model.start_sigma_m)};
  std::array<double, 2> velocity{draw(model.start_velocity_sigma_mps), draw(model.start_velocity_sigma_mps)};
  std::array<double, 2> tilt{draw(model.start_tilt_sigma_rad), draw(model.start_tilt_sigma_rad)};
  double heading = draw(model.start_heading_sigma_rad);
  std::array<double, 2> accel{draw(model.accel_bias_mps2), draw(model.accel_bias_mps2)};
  std::array<double, 3> gyro{draw(model.gyro_bias_radps), draw(model.gyro_bias_radps), draw(model.gyro_bias_radps)};
  const double accel_scale = draw(model.accel_scale);
  const double gyro_scale = draw(model.gyro_scale);
  // 60 s east, a turn to the south within 6 s, 60 s south.
  double course = M_PI / 2;
  for (double t = 0; t < 126; t += kDt) {
    const double rate = t >= 60 && t < 66 ? M_PI / 2 / 6 : 0;
    const std::array<double, 2> forward{std::sin(course), std::cos(course)};
    const std::array<double, 2> right{std::cos(course), -std::sin(course)};
    const std::array<double, 2> force{25 * rate * right[0], 25 * rate * right[1]};
    for (std::size_t i = 0; i < 2; ++i) {
      const double turned = i == 0 ? force[1] * heading : -force[0] * heading;
      position[i] += velocity[i] * kDt;
      velocity[i] +=
          (kG * tilt[i] + forward[i] * accel[0] + right[i] * accel[1] + turned + accel_scale * force[i]) * kDt +
          draw(model.velocity_random_walk_mps_rt_s * std::sqrt(kDt));
    }
    for (std::size_t i = 0; i < 2; ++i) {
      tilt[i] += (forward[i] * gyro[0] + right[i] * gyro[1] - velocity[i] / 6371000) * kDt +
                 draw(model.angle_random_walk_rad_rt_s * std::sqrt(kDt));
      accel[i] = decay * accel[i] + draw(kick * model.accel_bias_mps2);
    }
    heading += (gyro[2] + gyro_scale * rate) * kDt + draw(model.angle_random_walk_rad_rt_s * std::sqrt(kDt));
    for (double& bias : gyro) bias = decay * bias + draw(kick * model.gyro_bias_radps);
    course += rate * kDt;
  }
  return {position[0], position[1]};
}

// The covariance says what 400 simulated flights do: each variance within 4 standard errors (√(2/n) of itself).
TEST(InsState, AgreesWithSimulatedFlights) {
  InsErrorModel model = everything();
  model.start_heading_sigma_rad = 0.05;  // so that the turn matters
  model.bias_correlation_s = 50;
  InsState state = initial_ins_state(model, 90, 25);
  state = propagate(state, 60, 90, 25, model);
  for (int i = 1; i <= 60; ++i) state = propagate(state, 0.1, 90 + 1.5 * i, 25, model);
  state = propagate(state, 60, 180, 25, model);
  Random random(seed_from_name("InsState.AgreesWithSimulatedFlights"));
  constexpr int kFlights = 400;
  double east = 0;
  double north = 0;
  double product = 0;
  for (int i = 0; i < kFlights; ++i) {
    const PositionError error = simulate(model, random);
    east += error.east_m * error.east_m / kFlights;
    north += error.north_m * error.north_m / kFlights;
    product += error.east_m * error.north_m / kFlights;
  }
  const double tolerance = 4 * std::sqrt(2.0 / kFlights);
  EXPECT_NEAR(east / state.covariance(0, 0), 1, tolerance);
  EXPECT_NEAR(north / state.covariance(1, 1), 1, tolerance);
  const double scale = std::sqrt(state.covariance(0, 0) * state.covariance(1, 1));
  EXPECT_NEAR(product / scale, state.covariance(0, 1) / scale, 4 / std::sqrt(1.0 * kFlights));
}

}  // namespace
}  // namespace pilotage
