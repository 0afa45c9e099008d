#include "pilotage/navigate/navigation_filter.h"

#include <cmath>
#include <limits>

#include "testing/error_of.h"
#include "testing/flown_path.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/geo/position_covariance.h"
#include "pilotage/ins/ins_state.h"

namespace pilotage {
namespace {

constexpr GeodeticPoint kSomewhere{16.5, 55.5};

InsErrorModel graded(InsGrade grade) {
  InsOptions options;
  options.grade = grade;
  return make_ins_error_model(options);
}

/// Nothing but what a test sets.
InsErrorModel nothing() {
  InsErrorModel model;
  model.start_sigma_m = 0.01;
  return model;
}

NavigationOptions map_of(double sigma_m) {
  NavigationOptions options;
  options.map_sigma_m = sigma_m;
  return options;
}

/// The largest standard deviation of the position after flying straight without fixes.
double sigma_after_m(const InsErrorModel& model, double duration_s, bool barometer = true) {
  FlownPath path(kSomewhere, 20, 40);
  NavigationFilter filter(model, {}, path.state());
  for (int i = 1; i <= static_cast<int>(duration_s * 50); ++i) {
    filter.advance(path.fly(0.02));
    if (barometer && i % 50 == 0) filter.take_height(FlownPath::kHeight_m);
  }
  return largest_sigma_m(filter.estimate().covariance_en_m2);
}

PositionMeasurement measured_at(const InertialState& truth, const Eigen::Vector2d& off_m, double sigma_m,
                                double map_sigma_m = kUnknownMapSigma_m) {
  const GeodeticPoint point = geodetic_from_ecef(truth.position_m);
  return {LocalFrame(point).geodetic_from_enu({off_m.x(), off_m.y(), 0}), isotropic_covariance_m2(sigma_m),
          map_sigma_m};
}

Eigen::Vector2d off_truth_m(const NavigationFilter& filter, const InertialState& truth) {
  return LocalFrame(geodetic_from_ecef(truth.position_m))
      .enu_from_geodetic(geodetic_from_ecef(filter.state().position_m))
      .head<2>();
}

TEST(NavigationFilter, CovarianceGrowsAsTheClosedForms) {
  constexpr double kTime_s = 100;
  constexpr double kG = 9.81;
  const auto check = [&](const InsErrorModel& model, double expected_m) {
    EXPECT_NEAR(std::sqrt(std::pow(sigma_after_m(model, kTime_s), 2) - 1e-4) / expected_m, 1, 0.01) << expected_m;
  };
  InsErrorModel model = nothing();
  model.start_velocity_sigma_mps = 1;
  check(model, kTime_s);
  model = nothing();
  model.accel_bias_mps2 = 0.01;
  check(model, 0.01 * kTime_s * kTime_s / 2);
  model = nothing();
  model.start_tilt_sigma_rad = 0.001;
  check(model, kG * 0.001 * kTime_s * kTime_s / 2);
  model = nothing();
  model.gyro_bias_radps = 1e-5;
  check(model, kG * 1e-5 * std::pow(kTime_s, 3) / 6);
  model = nothing();
  model.velocity_random_walk_mps_rt_s = 0.01;
  check(model, 0.01 * std::sqrt(std::pow(kTime_s, 3) / 3));
  model = nothing();
  model.angle_random_walk_rad_rt_s = 1e-4;
  check(model, kG * 1e-4 * std::sqrt(std::pow(kTime_s, 5) / 20));
}

TEST(NavigationFilter, AnErrorGrowsAsItsClosedForm) {
  // The mechanisation itself, with a bias that nobody knows of.
  FlownPath path(kSomewhere, 20, 0);
  NavigationFilter filter(graded(InsGrade::kNavigation), {}, path.state());
  const double bias_mps2 = 0.01;
  for (int i = 0; i < 6000; ++i) {
    ImuIncrement increment = path.fly(0.01);
    increment.velocity_mps.y() += bias_mps2 * increment.dt_s;
    filter.advance(increment);
  }
  const Eigen::Vector2d off_m = off_truth_m(filter, path.state());
  EXPECT_NEAR(off_m.x() / (bias_mps2 * 60 * 60 / 2), 1, 0.005);
  EXPECT_LT(std::abs(off_m.y()), 0.2);
}

TEST(NavigationFilter, CovarianceAgreesWithThatOfThePlan) {
  for (const InsGrade grade :
       {InsGrade::kConsumer, InsGrade::kIndustrial, InsGrade::kTactical, InsGrade::kNavigation}) {
    const InsErrorModel model = graded(grade);
    for (const double duration_s : {20.0, 60.0, 120.0}) {
      const InsState planned = propagate(initial_ins_state(model, 40, 20), duration_s, 40, 20, model);
      // The plan has no scale errors in straight flight; gravity through that of the accelerometers is vertical.
      EXPECT_NEAR(sigma_after_m(model, duration_s) / position_error_m(planned, 1), 1, 0.02)
          << options_detail::enum_to_name(grade) << " " << duration_s;
    }
  }
}

TEST(NavigationFilter, FixesAgreeWithThoseOfThePlan) {
  const InsErrorModel model = graded(InsGrade::kTactical);
  NavigationFilter filter(model, map_of(0), FlownPath(kSomewhere, 20, 40).state());
  FlownPath path(kSomewhere, 20, 40);
  InsState planned = initial_ins_state(model, 40, 20);
  for (int k = 0; k < 6; ++k) {
    for (int i = 1; i <= 1000; ++i) {
      filter.advance(path.fly(0.02));
      if (i % 50 == 0) filter.take_height(FlownPath::kHeight_m);
    }
    planned = propagate(planned, 20, 40, 20, model);
    EXPECT_NEAR(largest_sigma_m(filter.estimate().covariance_en_m2) / position_error_m(planned, 1), 1, 0.02) << k;
    EXPECT_EQ(filter.take_fix(filter.take_frame(), measured_at(path.state(), {0, 0}, 2)).outcome, FixOutcome::kTaken);
    planned = update_with_fix(planned, 2);
  }
}

/// Flies a turn with fixes and heights; fixes come `late_s` after the exposure.
NavigationFilter flown_with_delay(double late_s) {
  const InsErrorModel model = graded(InsGrade::kTactical);
  FlownPath path(kSomewhere, 25, 10, {{12, 6, 60}});
  InertialState start = path.state();
  start.velocity_mps += Eigen::Vector3d(0.03, -0.04, 0.02);
  NavigationFilter filter(model, {}, start);
  FrameNumber frame = -1;
  PositionMeasurement waiting;
  double due_s = std::numeric_limits<double>::infinity();
  for (int i = 1; i <= 3000; ++i) {
    filter.advance(path.fly(0.01));
    if (i % 100 == 0) filter.take_height(FlownPath::kHeight_m + 3);
    const double now_s = path.state().time_s;
    if (i == 700 || i == 1500 || i == 2600) {
      frame = filter.take_frame();
      waiting = measured_at(path.state(), {2, -1}, 2);
      due_s = now_s + late_s;
    }
    if (now_s >= due_s - 1e-6) {
      EXPECT_EQ(filter.take_fix(frame, waiting).outcome, FixOutcome::kTaken);
      due_s = std::numeric_limits<double>::infinity();
    }
  }
  return filter;
}

TEST(NavigationFilter, AFixThatComesLateSaysTheSame) {
  NavigationFilter at_once = flown_with_delay(0);
  NavigationFilter late = flown_with_delay(3);
  // Linearised at another state: a few millimetres of what the fixes move it by, metres.
  EXPECT_LT((at_once.state().position_m - late.state().position_m).norm(), 0.02);
  EXPECT_LT((at_once.state().velocity_mps - late.state().velocity_mps).norm(), 0.001);
  const Eigen::Matrix2d a = at_once.estimate().covariance_en_m2;
  const Eigen::Matrix2d b = late.estimate().covariance_en_m2;
  EXPECT_LT((a - b).norm(), 1e-3 * a.norm());
  // Taken as if it were of now it would be off by 75 m a second.
}

TEST(NavigationFilter, ForgetsTheOldestFrame) {
  FlownPath path(kSomewhere, 25, 10);
  NavigationFilter filter(graded(InsGrade::kTactical), {}, path.state());
  std::vector<FrameNumber> frames;
  for (int i = 0; i <= NavigationErrors::kMostFrames; ++i) {
    frames.push_back(filter.take_frame());
    filter.advance(path.fly(0.01));
  }
  const PositionMeasurement measured = measured_at(path.state(), {0, 0}, 3);
  EXPECT_EQ(filter.take_fix(frames[0], measured).outcome, FixOutcome::kForgotten);
  EXPECT_FALSE(filter.match_prior(frames[0], 100));
  EXPECT_EQ(filter.take_fix(frames[1], measured).outcome, FixOutcome::kTaken);
  EXPECT_EQ(filter.take_fix(frames[1], measured).outcome, FixOutcome::kForgotten) << "only once";
  EXPECT_EQ(filter.take_fix(frames.back(), measured).outcome, FixOutcome::kTaken);
  EXPECT_EQ(filter.take_fix(-1, measured).outcome, FixOutcome::kForgotten);
  EXPECT_EQ(filter.take_fix(99, measured).outcome, FixOutcome::kForgotten);
}

TEST(NavigationFilter, ManyFixesOverOneTileDoNotMakeItSureOfTheGround) {
  FlownPath path(kSomewhere, 0.5, 10);  // hardly moves
  NavigationOptions options = map_of(3);
  NavigationFilter filter(graded(InsGrade::kTactical), options, path.state());
  for (int i = 1; i <= 12000; ++i) {
    filter.advance(path.fly(0.01));
    if (i % 100 == 0) filter.take_height(FlownPath::kHeight_m);
    if (i % 100 == 0) filter.take_fix(filter.take_frame(), measured_at(path.state(), {0, 0}, std::sqrt(9 + 1.0), 3));
  }
  // Start and map share what the fixes cannot tell apart: 3 m against 3 m.
  EXPECT_GT(largest_sigma_m(filter.estimate().covariance_en_m2), 1.9);
  EXPECT_LT(largest_sigma_m(filter.match_prior(filter.take_frame(), 100)->covariance_en_m2), 0.6)
      << "by the map itself it is known well";
}

TEST(NavigationFilter, RefusesAFalseFixAndBelievesMany) {
  FlownPath path(kSomewhere, 20, 90);
  InertialState start = path.state();
  NavigationFilter filter(graded(InsGrade::kTactical), {}, start);
  const auto fly = [&] {
    for (int i = 0; i < 100; ++i) filter.advance(path.fly(0.01));
  };
  fly();
  const Eigen::Vector3d before_m = filter.state().position_m;
  const FixUpdate refused = filter.take_fix(filter.take_frame(), measured_at(path.state(), {80, 10}, 2));
  EXPECT_EQ(refused.outcome, FixOutcome::kRefused);
  EXPECT_NEAR(refused.innovation_m.x(), -80, 0.5);
  EXPECT_GT(refused.normalized_innovation_squared, 100);
  EXPECT_EQ(filter.state().position_m, before_m) << "nothing was moved";

  // Scattered false fixes are never believed,
  for (int k = 0; k < 10; ++k) {
    fly();
    const Eigen::Vector2d off_m(k % 2 == 0 ? 90 : -70, k % 3 == 0 ? 120 : -50);
    EXPECT_EQ(filter.take_fix(filter.take_frame(), measured_at(path.state(), off_m, 2)).outcome, FixOutcome::kRefused);
  }
  // those that say the same are, at the fourth.
  for (int k = 0; k < 4; ++k) {
    fly();
    const FixUpdate update = filter.take_fix(filter.take_frame(), measured_at(path.state(), {60, -30}, 2));
    EXPECT_EQ(update.outcome, k < 3 ? FixOutcome::kRefused : FixOutcome::kReset) << k;
  }
  EXPECT_LT((off_truth_m(filter, path.state()) - Eigen::Vector2d(60, -30)).norm(), 3);
  fly();
  EXPECT_EQ(filter.take_fix(filter.take_frame(), measured_at(path.state(), {60, -30}, 2)).outcome, FixOutcome::kTaken);
}

TEST(NavigationFilter, BarometerHoldsTheHeight) {
  FlownPath path(kSomewhere, 20, 90);
  NavigationFilter filter(graded(InsGrade::kIndustrial), {}, path.state());
  for (int i = 1; i <= 30000; ++i) {
    ImuIncrement increment = path.fly(0.01);
    increment.velocity_mps.z() += 0.005 * increment.dt_s;  // 0.5 mg down
    filter.advance(increment);
    const Eigen::Vector3d at_m = path.state().position_m;
    if (i % 20 == 0) filter.take_height(height_from_ecef(at_m, geodetic_from_ecef(at_m)) + 4);
  }
  const Eigen::Vector3d at_m = path.state().position_m;
  EXPECT_NEAR(filter.estimate().height_m, height_from_ecef(at_m, geodetic_from_ecef(at_m)), 4.5);
}

TEST(NavigationFilter, AidingVelocityBoundsTheDrift) {
  InsErrorModel model = graded(InsGrade::kIndustrial);
  model.velocity_aid_sigma_mps = 1;
  FlownPath path(kSomewhere, 20, 40);
  NavigationFilter filter(model, {}, path.state());
  for (int i = 1; i <= 6000; ++i) {
    filter.advance(path.fly(0.02));
    if (i % 50 == 0) filter.take_height(FlownPath::kHeight_m);
    if (i % 25 == 0) {
      filter.take_velocity((enu_from_ecef(kSomewhere) * path.state().velocity_mps).head<2>(), 0.5);
    }
  }
  const InsState planned = propagate(initial_ins_state(model, 40, 20), 120, 40, 20, model);
  EXPECT_NEAR(largest_sigma_m(filter.estimate().covariance_en_m2) / position_error_m(planned, 1), 1, 0.02);
  EXPECT_FALSE(NavigationFilter(graded(InsGrade::kTactical), {}, path.state()).take_velocity({1, 2}, 1));
}

TEST(NavigationFilter, TakesNothingThatIsNoMeasurement) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  FlownPath path(kSomewhere, 20, 40);
  NavigationFilter filter(graded(InsGrade::kTactical), {}, path.state());
  ImuIncrement increment = path.fly(0.01);
  for (const double dt_s : {0.0, -0.01, 1.5, kNaN}) {
    increment.dt_s = dt_s;
    EXPECT_FALSE(filter.advance(increment)) << dt_s;
  }
  increment.dt_s = 0.01;
  increment.angle_rad.x() = kNaN;
  EXPECT_FALSE(filter.advance(increment));
  EXPECT_FALSE(filter.take_height(kNaN));
  const FrameNumber frame = filter.take_frame();
  PositionMeasurement bad = measured_at(path.state(), {0, 0}, 0.5);  // less than the map's own error
  EXPECT_EQ(filter.take_fix(frame, bad).outcome, FixOutcome::kUnusable);
  bad = measured_at(path.state(), {0, 0}, 3);
  bad.position.lat_deg = kNaN;
  EXPECT_EQ(filter.take_fix(frame, bad).outcome, FixOutcome::kUnusable);
  bad = measured_at(path.state(), {0, 0}, 3);
  bad.covariance_en_m2(0, 1) = bad.covariance_en_m2(1, 0) = 20;
  EXPECT_EQ(filter.take_fix(frame, bad).outcome, FixOutcome::kUnusable);
  EXPECT_EQ(filter.take_fix(frame, measured_at(path.state(), {0, 0}, 3)).outcome, FixOutcome::kTaken)
      << "the frame still waits";
}

TEST(NavigationFilter, RefusesAStartOrAModelThatCannotFly) {
  const InertialState start = FlownPath(kSomewhere, 20, 40).state();
  InertialState nowhere = start;
  nowhere.position_m.setZero();
  const InsErrorModel model = graded(InsGrade::kTactical);
  EXPECT_THROW(NavigationFilter(model, {}, nowhere), UsageError);
  nowhere.position_m.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(NavigationFilter(model, {}, nowhere), UsageError);
  EXPECT_THROW(NavigationFilter(graded(InsGrade::kVisualOdometry), {}, start), UsageError);
  EXPECT_THROW(NavigationFilter(model, map_of(-1), start), UsageError);
}

}  // namespace
}  // namespace pilotage
