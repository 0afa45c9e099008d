#include "aircraft.h"

#include <cmath>

#include "ring_scene.h"
#include <gtest/gtest.h>

namespace pilotage {
namespace {

constexpr GeodeticPoint kMiddle{16.5, 55.5};

InsErrorModel no_errors() {
  InsErrorModel model;
  model.start_sigma_m = 1e-6;
  return model;
}

/// A circle of 28 m at 5 m/s, nose to the middle.
void fly_round(Aircraft& aircraft, double seconds) {
  while (aircraft.time_s() < seconds) {
    const Eigen::Vector3d at = aircraft.believed().position_m;
    aircraft.fly(5 * direction(bearing_deg(at) + 90, 0), bearing_deg(at) + 180);
  }
}

TEST(Aircraft, WithoutErrorsItIsWhereItBelieves) {
  Aircraft aircraft(kMiddle, no_errors(), 0.05, {0, 28, 10}, 180, 1);
  fly_round(aircraft, 20);
  EXPECT_LT((aircraft.truth().position_m - aircraft.believed().position_m).norm(), 0.05);
  EXPECT_NEAR(aircraft.truth().velocity_mps.norm(), 5, 0.1);
  EXPECT_NEAR(aircraft.truth().position_m.z(), 10, 0.2);
  const Eigen::Vector3d nose = aircraft.truth().enu_from_body.col(0);
  EXPECT_GT(nose.dot(-aircraft.truth().position_m.normalized()), 0.9);
  EXPECT_GT((aircraft.truth().position_m - Eigen::Vector3d(0, 28, 10)).norm(), 20);
}

TEST(Aircraft, DriftsAsItsGradeAndACopyFliesTheSame) {
  InsOptions ins;
  ins.grade = InsGrade::kConsumer;
  Aircraft aircraft(kMiddle, make_ins_error_model(ins), 0.05, {0, 28, 10}, 180, 1);
  fly_round(aircraft, 2);
  Aircraft copy = aircraft;
  fly_round(aircraft, 20);
  fly_round(copy, 20);
  EXPECT_EQ(aircraft.truth().position_m, copy.truth().position_m);
  EXPECT_EQ(aircraft.believed().position_m, copy.believed().position_m);
  EXPECT_GT((aircraft.truth().position_m - aircraft.believed().position_m).head<2>().norm(), 2);
  EXPECT_LT(std::abs(aircraft.truth().position_m.z() - aircraft.believed().position_m.z()), 0.3) << "the altimeter";
}

// Position and turn of many starts, against the covariance that the sights of rings are given.
TEST(Aircraft, PoseCovarianceIsThatOfTheErrors) {
  InsOptions ins;
  ins.grade = InsGrade::kConsumer;
  double nees = 0;
  constexpr int kRuns = 60;
  for (std::uint64_t seed = 0; seed < kRuns; ++seed) {
    Aircraft aircraft(kMiddle, make_ins_error_model(ins), 0.05, {0, 28, 10}, 180, seed);
    fly_round(aircraft, 1);
    const FieldState truth = aircraft.truth();
    const FieldState believed = aircraft.believed();
    const Eigen::AngleAxisd turn(believed.enu_from_body * truth.enu_from_body.transpose());
    Eigen::Matrix<double, 6, 1> error;
    error << believed.position_m - truth.position_m, turn.angle() * turn.axis();
    nees += error.dot(aircraft.pose_covariance().ldlt().solve(error)) / kRuns;
  }
  EXPECT_GT(nees, 4.9);  // χ² of 360 degrees, 0.1 % to both sides, over 60
  EXPECT_LT(nees, 7.5);
}

}  // namespace
}  // namespace pilotage
