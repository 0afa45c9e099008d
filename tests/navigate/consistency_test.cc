#include <cmath>

#include "testing/flown_path.h"
#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "pilotage/base/parallel.h"
#include "pilotage/base/statistics.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/navigate/navigation_filter.h"

namespace pilotage {
namespace {

constexpr int kRuns = 400;

/// How a run ends: normalised squared errors, which are χ² where the covariance is honest.
struct RunEnd {
  double position = 0;     ///< Two degrees.
  double inertial = 0;     ///< Place, velocity, attitude, biases: fifteen.
  double innovations = 0;  ///< Sum over the fixes.
  int fixes = 0;
  double neighbours = 0;  ///< Sum of ν_kᵀ ν_k+1, each scaled to unit variance: 0 on the average.
};

RunEnd run(InsGrade grade, std::uint64_t seed, double map_in_filter_sigma_m) {
  Random random(seed);
  InsOptions ins;
  ins.grade = grade;
  const InsErrorModel model = make_ins_error_model(ins);
  constexpr double kMapSigma_m = 3;
  constexpr double kFixSigma_m = 1.5;
  NavigationOptions options;
  options.map_sigma_m = map_in_filter_sigma_m;
  FlownPath path({16.5, 55.5}, 25, 20, {{15, 10, 90}, {45, 8, -60}});
  SimulatedImu imu(model, random);
  SlowError<2> map(kMapSigma_m, options.map_correlation_m, random);
  SlowError<1> barometer(options.barometer_sigma_m, options.barometer_correlation_s, random);
  NavigationFilter filter(model, options, wrong_start(path.state(), model, random));
  RunEnd end;
  Eigen::Vector2d before = Eigen::Vector2d::Zero();
  constexpr double kStep_s = 0.025;
  for (int i = 1; i <= 2800; ++i) {
    filter.advance(imu.measure(path.fly(kStep_s)));
    const GeodeticPoint point = geodetic_from_ecef(path.state().position_m);
    if (i % 40 == 0) {
      map.go_on(40 * kStep_s * 25, random);
      barometer.go_on(40 * kStep_s, random);
      filter.take_height(height_from_ecef(path.state().position_m, point) + barometer.value[0] +
                         options.barometer_noise_m * random.normal());
    }
    if (i % 120 != 0) continue;
    const Eigen::Vector2d off_m = map.value + kFixSigma_m * Eigen::Vector2d(random.normal(), random.normal());
    const FrameNumber frame = filter.take_frame();
    const Eigen::Matrix2d noise = isotropic_covariance_m2(kFixSigma_m);
    const Eigen::Matrix2d innovation = filter.match_prior(frame, 100)->covariance_en_m2 + noise;
    const FixUpdate update =
        filter.take_fix(frame, {LocalFrame(point).geodetic_from_enu({off_m.x(), off_m.y(), 0}),
                                noise + isotropic_covariance_m2(options.map_sigma_m), options.map_sigma_m});
    end.innovations += update.normalized_innovation_squared;
    ++end.fixes;
    const Eigen::Vector2d scaled = innovation.llt().matrixL().solve(update.innovation_m);
    end.neighbours += scaled.dot(before);
    before = scaled;
  }
  const InertialState truth = path.state();
  const Eigen::Matrix3d to_enu = enu_from_ecef(geodetic_from_ecef(truth.position_m));
  const Eigen::Vector3d off_m = to_enu * (filter.state().position_m - truth.position_m);
  end.position = mahalanobis_squared(off_m.head<2>(), filter.estimate().covariance_en_m2);
  const Eigen::AngleAxisd turn(filter.state().ecef_from_body * truth.ecef_from_body.conjugate());
  Eigen::Matrix<double, 15, 1> errors;
  errors << filter.state().position_m - truth.position_m, filter.state().velocity_mps - truth.velocity_mps,
      turn.angle() * turn.axis(), filter.estimate().gyro_bias_radps - imu.gyro_bias_radps(),
      filter.estimate().accel_bias_mps2 - imu.accel_bias_mps2();
  const Eigen::Matrix<double, 15, 15> covariance = filter.covariance().topLeftCorner<15, 15>();
  end.inertial = errors.dot(covariance.ldlt().solve(errors));
  return end;
}

RunEnd mean_of_runs(InsGrade grade, double map_in_filter_sigma_m) {
  std::vector<RunEnd> ends(kRuns);
  parallel_for(ends.size(), 0, [&](std::size_t i, int) {
    ends[i] = run(grade, derive_seed(seed_from_name("Consistency " + options_detail::enum_to_name(grade)), i),
                  map_in_filter_sigma_m);
  });
  RunEnd sum;
  for (const RunEnd& end : ends) {
    sum.position += end.position / kRuns;
    sum.inertial += end.inertial / kRuns;
    sum.innovations += end.innovations;
    sum.fixes += end.fixes;
    sum.neighbours += end.neighbours;
  }
  return sum;
}

Interval band(int degrees, double count) {
  return {chi_squared_quantile(0.025, degrees * count) / count, chi_squared_quantile(0.975, degrees * count) / count};
}

TEST(Consistency, CovarianceOfTheWholeLoopIsHonest) {
  for (const InsGrade grade : {InsGrade::kIndustrial, InsGrade::kTactical}) {
    const RunEnd mean = mean_of_runs(grade, 3);
    const Interval position = band(2, kRuns);
    EXPECT_GT(mean.position, position.low);
    EXPECT_LT(mean.position, position.high);
    const Interval inertial = band(15, kRuns);
    EXPECT_GT(mean.inertial, inertial.low);
    EXPECT_LT(mean.inertial, inertial.high);
    const Interval innovations = band(2, mean.fixes);
    EXPECT_GT(mean.innovations / mean.fixes, innovations.low);
    EXPECT_LT(mean.innovations / mean.fixes, innovations.high);
    // Sum of products of independent unit normals, two a fix.
    EXPECT_LT(std::abs(mean.neighbours), 2.5 * std::sqrt(2.0 * mean.fixes)) << "innovations are white";
    std::printf("[  NEES   ] position %.3f in [%.3f, %.3f], 15 states %.2f in [%.2f, %.2f], NIS %.3f in [%.3f, %.3f]\n",
                mean.position, position.low, position.high, mean.inertial, inertial.low, inertial.high,
                mean.innovations / mean.fixes, innovations.low, innovations.high);
  }
}

TEST(Consistency, AFilterThatTakesTheMapForTruthIsOverconfident) {
  EXPECT_GT(mean_of_runs(InsGrade::kTactical, 0).position, 2 * band(2, kRuns).high);
}

}  // namespace
}  // namespace pilotage
