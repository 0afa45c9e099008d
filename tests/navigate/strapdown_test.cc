#include "pilotage/navigate/strapdown.h"

#include <cmath>

#include "testing/flown_path.h"
#include <gtest/gtest.h>

#include "pilotage/geo/ecef.h"

namespace pilotage {
namespace {

constexpr GeodeticPoint kPlace{16.5, 55.5};

/// What is left after `duration_s` of the increments of an IMU without errors.
double error_after_m(FlownPath path, double duration_s, double rate_hz, double* attitude_rad = nullptr) {
  InertialState state = path.state();
  ImuIncrement before;
  for (int i = 0; i < static_cast<int>(duration_s * rate_hz); ++i) {
    const ImuIncrement now = path.fly(1 / rate_hz);
    state = advance(state, now, before);
    before = now;
  }
  if (attitude_rad != nullptr) *attitude_rad = state.ecef_from_body.angularDistance(path.state().ecef_from_body);
  return (state.position_m - path.state().position_m).norm();
}

TEST(Strapdown, GravityIsTheNormalGravityOfWgs84) {
  // H. Moritz, Geodetic Reference System 1980, with the constants of WGS 84: equator, 45°, pole.
  EXPECT_NEAR(gravity_mps2(ecef_from_geodetic({0, 0}, 0)).norm(), 9.7803253359, 1e-6);
  EXPECT_NEAR(gravity_mps2(ecef_from_geodetic({30, 45}, 0)).norm(), 9.8061977695, 1e-6);
  EXPECT_NEAR(gravity_mps2(ecef_from_geodetic({0, -90}, 0)).norm(), 9.8321849378, 1e-6);
  EXPECT_NEAR(gravity_mps2(ecef_from_geodetic({0, 45}, 1000)).norm() - 9.8061977695, -3.086e-3, 2e-6);
  const Eigen::Vector3d enu = enu_from_ecef(kPlace) * gravity_mps2(ecef_from_geodetic(kPlace, 0));
  EXPECT_LT(enu.head<2>().norm(), 1e-6) << "straight down";
}

TEST(Strapdown, StandsStillOnTheTurningEarth) {
  EXPECT_LT(error_after_m(FlownPath(kPlace, 0, 30), 600, 100), 1e-4);
}

TEST(Strapdown, TenMinutesWithTurnsComeBackToACentimetre) {
  const FlownPath path(kPlace, 30, 20, {{30, 12, 90}, {100, 20, -170}, {200, 8, 60}, {300, 15, 180}, {450, 10, -90}});
  double attitude_rad = 0;
  EXPECT_LT(error_after_m(path, 600, 100, &attitude_rad), 0.01);
  EXPECT_LT(attitude_rad, 1e-7);
}

TEST(Strapdown, ConingDoesNotDrift) {
  const FlownPath path(kPlace, 30, 20, {{30, 12, 90}, {100, 20, -170}}, 0.3);
  double attitude_rad = 0;
  EXPECT_LT(error_after_m(path, 600, 200, &attitude_rad), 0.5);
  EXPECT_LT(attitude_rad, 5e-6);
  // Without the correction the attitude would drift by half the cone's solid angle a second: π a² f over 600 s.
  EXPECT_GT(std::acos(-1.0) * std::pow(0.3 * kRadPerDeg, 2) * 4 * 600, 0.2);
}

TEST(Strapdown, TellsAttitudeAndPlaceAgain) {
  const InertialState state = inertial_state(5, kPlace, 120, {3, 4, -1}, {200, -7, 12});
  const Attitude attitude = attitude_of(state);
  EXPECT_NEAR(attitude.yaw_deg, -160, 1e-9);
  EXPECT_NEAR(attitude.pitch_deg, -7, 1e-9);
  EXPECT_NEAR(attitude.roll_deg, 12, 1e-9);
  const GeodeticPoint point = geodetic_from_ecef(state.position_m);
  EXPECT_NEAR(point.lon_deg, 16.5, 1e-12);
  EXPECT_NEAR(point.lat_deg, 55.5, 1e-12);
  EXPECT_NEAR(height_from_ecef(state.position_m, point), 120, 1e-8);
  EXPECT_NEAR(state.velocity_mps.norm(), std::sqrt(26.0), 1e-12);
  EXPECT_EQ(state.time_s, 5);
}

}  // namespace
}  // namespace pilotage
