#include <cmath>
#include <vector>

#include "testing/flown_path.h"
#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

/// Overlapping Allan deviation of a rate from its integral at equal steps (D. Allan, "Statistics of atomic frequency
/// standards", Proc. IEEE 54, 1966).
double allan_deviation(const std::vector<double>& integral, double step_s, std::size_t m) {
  double sum = 0;
  const std::size_t count = integral.size() - 2 * m;
  for (std::size_t i = 0; i < count; ++i) {
    const double d = integral[i + 2 * m] - 2 * integral[i + m] + integral[i];
    sum += d * d;
  }
  const double tau_s = static_cast<double>(m) * step_s;
  return std::sqrt(sum / (2 * tau_s * tau_s * static_cast<double>(count)));
}

// σ²(τ) = N²/τ of the white noise and that of a first-order Gauss-Markov process with standing deviation B and
// correlation T (IEEE Std 952-1997, eq. C.17).
double specified_deviation(double noise_rt_s, double bias, double correlation_s, double tau_s) {
  const double x = tau_s / correlation_s;
  const double markov = 2 * bias * bias / x * (1 - (3 - 4 * std::exp(-x) + std::exp(-2 * x)) / (2 * x));
  return std::sqrt(noise_rt_s * noise_rt_s / tau_s + markov);
}

TEST(Allan, SimulatedSensorsAreThoseOfTheirSpecification) {
  for (const InsGrade grade : {InsGrade::kConsumer, InsGrade::kTactical}) {
    InsOptions options;
    options.grade = grade;
    const InsErrorModel model = make_ins_error_model(options);
    Random random(seed_from_name("Allan"));
    constexpr double kStep_s = 0.5;
    // Three axes of an hour each are nine hours of data in three sensors' draws.
    for (const double tau_s : {1.0, 10.0, 100.0}) {
      double gyro = 0;
      double accel = 0;
      for (int draw = 0; draw < 3; ++draw) {
        SimulatedImu imu(model, random);
        std::array<std::vector<double>, 6> integral;
        Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
        for (int i = 0; i < 7200; ++i) {
          ImuIncrement still;
          still.dt_s = kStep_s;
          const ImuIncrement counted = imu.measure(still);
          sum.head<3>() += counted.angle_rad;
          sum.tail<3>() += counted.velocity_mps;
          for (std::size_t axis = 0; axis < 6; ++axis) integral[axis].push_back(sum[static_cast<Eigen::Index>(axis)]);
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const auto m = static_cast<std::size_t>(tau_s / kStep_s);
          gyro += std::pow(allan_deviation(integral[axis], kStep_s, m), 2) / 9;
          accel += std::pow(allan_deviation(integral[axis + 3], kStep_s, m), 2) / 9;
        }
      }
      // 324 independent pairs at 100 s: 5.6 % of a deviation's variance root; three of these, below 10 s less.
      const double tolerance = tau_s < 50 ? 0.05 : 0.15;
      EXPECT_NEAR(std::sqrt(gyro) / specified_deviation(model.angle_random_walk_rad_rt_s, model.gyro_bias_radps,
                                                        model.bias_correlation_s, tau_s),
                  1, tolerance)
          << tau_s;
      EXPECT_NEAR(std::sqrt(accel) / specified_deviation(model.velocity_random_walk_mps_rt_s, model.accel_bias_mps2,
                                                         model.bias_correlation_s, tau_s),
                  1, tolerance)
          << tau_s;
    }
  }
}

}  // namespace
}  // namespace pilotage
