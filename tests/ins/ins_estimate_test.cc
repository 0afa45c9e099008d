#include <gtest/gtest.h>

#include "pilotage/ins/ins_state.h"

namespace pilotage {
namespace {

InsErrorModel aided() {
  InsOptions options;
  options.grade = InsGrade::kIndustrial;
  options.velocity_aid_sigma_mps = 1;
  return make_ins_error_model(options);
}

TEST(InsEstimate, CovarianceIsThatOfTheStateAlone) {
  const InsErrorModel model = aided();
  InsState state = initial_ins_state(model, 10, 20);
  InsEstimate estimate{state};
  for (const double heading_deg : {10.0, 100.0, 70.0}) {
    const InsStep step = make_ins_step(7, heading_deg, 20, model);
    state = propagate(state, step);
    estimate = propagate(estimate, step);
    EXPECT_EQ(estimate.state.covariance, state.covariance) << heading_deg;
    state = update_with_fix(state, 2);
    estimate = update_with_position_error(estimate, {0, 0}, 4 * Eigen::Matrix2d::Identity());
    EXPECT_LT((estimate.state.covariance - state.covariance).norm(), 1e-9 * state.covariance.norm());
  }
  EXPECT_EQ(estimate.errors.norm(), 0) << "nothing was ever off";
}

/// A tilt of 1 mrad leans the vertical: g τ t² / 2 of position, and a turn resolves along a heading that is off.
TEST(InsEstimate, ErrorsFollowTheEquations) {
  const InsErrorModel model = make_ins_error_model({});
  InsEstimate estimate{initial_ins_state(model, 0, 20)};
  estimate.errors(4) = 1e-3;
  estimate.errors(6) = 0.01;
  estimate = propagate(estimate, make_ins_step(20, 0, 20, model));
  EXPECT_NEAR(estimate.errors(0), 9.80665e-3 * 200, 1e-3);
  EXPECT_NEAR(estimate.errors(2), 9.80665e-3 * 20, 1e-4);
  EXPECT_NEAR(estimate.errors(3), 0, 1e-9);
  estimate = propagate(estimate, make_ins_step(0.001, 90, 20, model));
  // From 20 m/s north to 20 m/s east: (20, −20), turned clockwise by 0.01 rad gives −0.2 of each.
  EXPECT_NEAR(estimate.errors(2), 9.80665e-3 * 20 - 0.2, 1e-4);
  EXPECT_NEAR(estimate.errors(3), -0.2, 1e-4);
}

}  // namespace
}  // namespace pilotage
