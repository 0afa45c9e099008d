#include "pilotage/simulate/drawn_errors.h"

#include <cmath>
#include <vector>

#include "testing/flown_path.h"
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "pilotage/base/parallel.h"
#include "pilotage/base/statistics.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/navigate/navigation_filter.h"

namespace pilotage {
namespace {

InsErrorModel drawn_model(InsGrade grade, double aid_mps = 0) {
  InsOptions options;
  options.grade = grade;
  if (aid_mps > 0) options.velocity_aid_sigma_mps = aid_mps;
  return make_ins_error_model(options);
}

InsErrorModel with_map(InsErrorModel model, double sigma_m) {
  model.map_sigma_m = sigma_m;
  return model;
}

/// Three courses with a fix after each.
DrawnErrors fly_courses(const InsErrorModel& model, Random& random, double fix_sigma_m) {
  DrawnErrors drawn = draw_errors(model, true, 10, 20, random);
  for (const double heading_deg : {10.0, 100.0, 70.0}) {
    const DrawnStep step(make_ins_step(12, heading_deg, 20, model));
    fly_step(drawn, step, random);
    take_fix(drawn, innovation_of_fix(drawn, fix_sigma_m, random), isotropic_covariance_m2(fix_sigma_m));
  }
  return drawn;
}

TEST(DrawnErrors, CovarianceIsThatOfThePlan) {
  for (const InsErrorModel& model : {drawn_model(InsGrade::kIndustrial), drawn_model(InsGrade::kIndustrial, 1),
                                     with_map(drawn_model(InsGrade::kVisualOdometry), 4)}) {
    Random random(1);
    const DrawnErrors drawn = fly_courses(model, random, 2);
    InsState state = initial_ins_state(model, 10, 20);
    for (const double heading_deg : {10.0, 100.0, 70.0}) {
      state = update_with_fix(propagate(state, 12, heading_deg, 20, model), 2);
    }
    EXPECT_LT((drawn.believed.covariance - state.covariance).norm(), 1e-9 * state.covariance.norm());
  }
}

TEST(DrawnErrors, AreDrawnFromTheirCovariance) {
  constexpr int kRuns = 2000;
  for (const InsErrorModel& model : {drawn_model(InsGrade::kTactical), drawn_model(InsGrade::kConsumer, 1),
                                     drawn_model(InsGrade::kVisualOdometry)}) {
    double sum = 0;
    for (std::uint64_t i = 0; i < kRuns; ++i) {
      Random random(derive_seed(seed_from_name("DrawnErrors"), i));
      const DrawnErrors drawn = fly_courses(with_map(model, 3), random, 2);
      sum += mahalanobis_squared(drawn.position_error_m(), drawn.position_covariance_m2());
    }
    EXPECT_GT(sum, chi_squared_quantile(0.005, 2 * kRuns));
    EXPECT_LT(sum, chi_squared_quantile(0.995, 2 * kRuns));
  }
}

TEST(DrawnErrors, RootOfASingularCovariance) {
  Eigen::Matrix<double, InsState::kSize, 3> thin = Eigen::Matrix<double, InsState::kSize, 3>::Zero();
  for (int i = 0; i < InsState::kSize; ++i) thin.row(i) << (i % 5) * 1e-3, i % 3 == 0 ? 20 : 0, i % 2;
  const InsState::Covariance covariance = thin * thin.transpose();
  const InsState::Covariance root = root_of(covariance);
  EXPECT_LT((root * root.transpose() - covariance).norm(), 1e-6 * covariance.norm());
  EXPECT_TRUE(root.isLowerTriangular(1e-12));
}

TEST(DrawnErrors, GnssHoldsThemAsInThePlan) {
  const InsErrorModel model = drawn_model(InsGrade::kTactical);
  constexpr int kRuns = 1000;
  double sum = 0;
  for (std::uint64_t i = 0; i < kRuns; ++i) {
    Random random(derive_seed(seed_from_name("GnssHolds"), i));
    DrawnErrors drawn = draw_errors(model, true, 70, 20, random);
    InsState state = initial_ins_state(model, 70, 20);
    const InsStep step = make_ins_step(100, 70, 20, model);
    fly_step(drawn, DrawnStep(step), random);
    hold_by_gnss(drawn, model, random);
    state = hold_with_gnss(propagate(state, step), 70, 20, model);
    if (i == 0) {
      EXPECT_LT((drawn.believed.covariance - state.covariance).norm(), 1e-9 * state.covariance.norm());
      EXPECT_LE(largest_sigma_m(drawn.position_covariance_m2()), model.start_sigma_m + 1e-9);
    }
    sum += drawn.errors.segment<2>(2).squaredNorm() / state.covariance(2, 2);  // velocity
  }
  EXPECT_GT(sum, chi_squared_quantile(0.005, 2 * kRuns));
  EXPECT_LT(sum, chi_squared_quantile(0.995, 2 * kRuns));
}

/// A flight of 70 s with two turns and a fix every 10 s, but for one gap, by the filter that flies.
struct StrapdownEnd {
  Eigen::Vector2d error_m;
  double sigma_m = 0;
};

constexpr double kFixSigma_m = 2;
constexpr double kMapOfBoth_m = 2;
constexpr double kMapOfBothCorrelation_m = 300;  // as an InsErrorModel has it
bool fix_at(int second) {
  return second % 10 == 0 && second != 40 && second != 50 && second != 70;
}

StrapdownEnd fly_strapdown(const InsErrorModel& model, std::uint64_t seed) {
  Random random(seed);
  FlownPath path({16.5, 55.5}, 25, 20, {{11, 12, 90}, {41, 12, -60}});
  SimulatedImu imu(model, random);
  SlowError<2> map(kMapOfBoth_m, kMapOfBothCorrelation_m, random);
  NavigationOptions options;
  options.map_sigma_m = kMapOfBoth_m;
  options.map_correlation_m = kMapOfBothCorrelation_m;
  NavigationFilter filter(model, options, wrong_start(path.state(), model, random));
  for (int i = 1; i <= 70 * 40; ++i) {
    filter.advance(imu.measure(path.fly(0.025)));
    if (i % 40 != 0) continue;
    map.go_on(25, random);
    const GeodeticPoint point = geodetic_from_ecef(path.state().position_m);
    filter.take_height(height_from_ecef(path.state().position_m, point) + 0.5 * random.normal());
    if (!fix_at(i / 40)) continue;
    const Eigen::Vector2d off_m = map.value + kFixSigma_m * Eigen::Vector2d(random.normal(), random.normal());
    filter.take_fix(filter.take_frame(),
                    {LocalFrame(point).geodetic_from_enu({off_m.x(), off_m.y(), 0}),
                     isotropic_covariance_m2(std::hypot(kFixSigma_m, kMapOfBoth_m)), kMapOfBoth_m});
  }
  const InertialState truth = path.state();
  const Eigen::Matrix3d to_enu = enu_from_ecef(geodetic_from_ecef(truth.position_m));
  return {(to_enu * (filter.state().position_m - truth.position_m)).head<2>(),
          largest_sigma_m(filter.estimate().covariance_en_m2)};
}

DrawnErrors fly_drawn(const InsErrorModel& model, std::uint64_t seed) {
  Random random(seed);
  DrawnErrors drawn = draw_errors(model, true, 20, 25, random);
  for (int second = 1; second <= 70; ++second) {
    const double heading_deg = second <= 17 ? 20 : second <= 47 ? 110 : 50;
    fly_step(drawn, DrawnStep(make_ins_step(1, heading_deg, 25, model)), random);
    if (fix_at(second))
      take_fix(drawn, innovation_of_fix(drawn, kFixSigma_m, random), isotropic_covariance_m2(kFixSigma_m));
  }
  return drawn;
}

TEST(DrawnErrorsThorough, AgreeWithTheFilterThatFlies) {
  constexpr std::size_t kRuns = 300;
  for (const InsGrade grade : {InsGrade::kIndustrial, InsGrade::kTactical}) {
    const InsErrorModel model = drawn_model(grade);
    std::vector<StrapdownEnd> strapdown(kRuns);
    std::vector<DrawnErrors> drawn(kRuns);
    parallel_for(kRuns, 0, [&](std::size_t i, int) {
      strapdown[i] = fly_strapdown(model, derive_seed(seed_from_name("strapdown"), i));
      drawn[i] = fly_drawn(with_map(model, kMapOfBoth_m), derive_seed(seed_from_name("drawn"), i));
    });
    double of_strapdown = 0;
    double of_drawn = 0;
    for (std::size_t i = 0; i < kRuns; ++i) {
      of_strapdown += strapdown[i].error_m.squaredNorm() / (2.0 * kRuns);
      of_drawn += drawn[i].position_error_m().squaredNorm() / (2.0 * kRuns);
    }
    EXPECT_NEAR(strapdown[0].sigma_m / largest_sigma_m(drawn[0].position_covariance_m2()), 1, 0.03);
    // Two sample variances of 600 values each, correlated at most in pairs: a ratio within ± 20 % in 95 of 100 cases.
    EXPECT_NEAR(of_strapdown / of_drawn, 1, 0.2);
    std::printf("[ AGREE    ] rms %.2f m strapdown, %.2f m drawn; sigma %.2f and %.2f m\n", std::sqrt(of_strapdown),
                std::sqrt(of_drawn), strapdown[0].sigma_m, largest_sigma_m(drawn[0].position_covariance_m2()));
  }
}

}  // namespace
}  // namespace pilotage
