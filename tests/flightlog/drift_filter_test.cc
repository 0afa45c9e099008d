#include "pilotage/flightlog/drift_filter.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"
#include "pilotage/base/statistics.h"
#include "pilotage/geo/position_covariance.h"

namespace pilotage {
namespace {

constexpr double kSpeed_mps = 20;
constexpr double kGravity_mps2 = 9.80665;

InsErrorModel tactical() {
  InsOptions options;
  options.grade = InsGrade::kTactical;
  return make_ins_error_model(options);
}

TEST(DriftFilter, WithoutFixesItIsTheErrorModel) {
  InsErrorModel model = tactical();
  model.start_sigma_m = 7;
  DriftFilter filter(model, 30, kSpeed_mps);
  filter.start({3, -4}, isotropic_covariance_m2(7));
  for (int i = 0; i < 12; ++i) filter.fly_on(5, 30, kSpeed_mps);
  const InsState ins = propagate(initial_ins_state(model, 30, kSpeed_mps), 60, 30, kSpeed_mps, model);
  const Eigen::Matrix2d expected = ins.covariance.topLeftCorner<2, 2>();
  EXPECT_LT((filter.covariance_m2() - expected).norm(), 1e-3 * expected.norm());
  EXPECT_EQ(filter.error_m(), Eigen::Vector2d(3, -4));
}

TEST(DriftFilter, FixesTellTheDrift) {
  DriftFilter filter(tactical(), 0, kSpeed_mps);
  const Eigen::Vector2d velocity(0.05, -0.03);
  filter.start({10, 5}, isotropic_covariance_m2(1));
  for (int i = 1; i <= 10; ++i) {
    filter.fly_on(3, 0, kSpeed_mps);
    filter.update(Eigen::Vector2d(10, 5) + 3 * i * velocity, isotropic_covariance_m2(0.1));
  }
  EXPECT_LT((filter.velocity_error_mps() - velocity).norm(), 0.01);
  filter.fly_on(3, 0, kSpeed_mps);
  EXPECT_LT((filter.error_m() - Eigen::Vector2d(10, 5) - 33 * velocity).norm(), 0.1);
  EXPECT_LT(largest_sigma_m(filter.covariance_m2()), 0.5);
}

TEST(DriftFilter, AFixOfNoWorthChangesNothing) {
  DriftFilter filter(tactical(), 0, kSpeed_mps);
  filter.start({1, 2}, isotropic_covariance_m2(3));
  filter.fly_on(4, 0, kSpeed_mps);
  const Eigen::Matrix2d before = filter.covariance_m2();
  filter.update({500, 500}, isotropic_covariance_m2(1e6));
  EXPECT_LT((filter.covariance_m2() - before).norm(), 1e-6 * before.norm());
  EXPECT_LT((filter.error_m() - Eigen::Vector2d(1, 2)).norm(), 1e-6 * 500);
}

/// Straight flights whose velocity, tilt and biases are drawn from the model, with a fix every four seconds.
TEST(DriftFilter, CovarianceIsThatOfItsErrors) {
  constexpr int kFlights = 400;
  const InsErrorModel model = tactical();
  Random random(seed_from_name("drift"));
  const auto draw = [&](double sigma) -> Eigen::Vector2d {
    const double first = random.normal();
    return sigma * Eigen::Vector2d(first, random.normal());
  };
  double sum = 0;
  for (int flight = 0; flight < kFlights; ++flight) {
    Eigen::Vector2d error = draw(5);
    Eigen::Vector2d velocity = draw(model.start_velocity_sigma_mps);
    Eigen::Vector2d acceleration = kGravity_mps2 * draw(model.start_tilt_sigma_rad) + draw(model.accel_bias_mps2);
    const Eigen::Vector2d jerk = kGravity_mps2 * draw(model.gyro_bias_radps);
    DriftFilter filter(model, 0, kSpeed_mps);
    filter.start(error + draw(2), isotropic_covariance_m2(2));
    for (int i = 0; i < 15; ++i) {
      for (int step = 0; step < 40; ++step) {  // of 0.1 s
        error += 0.1 * velocity;
        velocity += 0.1 * acceleration + draw(model.velocity_random_walk_mps_rt_s * std::sqrt(0.1));
        acceleration += 0.1 * jerk + kGravity_mps2 * draw(model.angle_random_walk_rad_rt_s * std::sqrt(0.1));
      }
      filter.fly_on(4, 0, kSpeed_mps);
      if (i < 14) filter.update(error + draw(2), isotropic_covariance_m2(2));
    }
    sum += mahalanobis_squared(filter.error_m() - error, filter.covariance_m2());
  }
  EXPECT_LT(sum, chi_squared_quantile(0.999, 2 * kFlights));
  EXPECT_GT(sum, chi_squared_quantile(0.001, 2 * kFlights));
}

}  // namespace
}  // namespace pilotage
