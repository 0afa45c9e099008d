#include "pilotage/ins/ins_error_model.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/options_json.h"

namespace pilotage {
namespace {

TEST(InsErrorModel, UnitsAreThoseOfDatasheets) {
  InsOptions options;
  options.grade = InsGrade::kCustom;
  options.accel_bias_mg = 1;
  options.gyro_bias_deg_h = 1;
  options.velocity_random_walk_mps_rt_h = 0.06;
  options.angle_random_walk_deg_rt_h = 0.15;
  options.accel_scale_ppm = 300;
  const InsErrorModel model = make_ins_error_model(options);
  EXPECT_NEAR(model.accel_bias_mps2, 9.80665e-3, 1e-12);
  EXPECT_NEAR(model.gyro_bias_radps, 4.84813681e-6, 1e-14);
  EXPECT_NEAR(model.velocity_random_walk_mps_rt_s, 1e-3, 1e-12);
  EXPECT_NEAR(model.angle_random_walk_rad_rt_s, 4.36332313e-5, 1e-13);
  EXPECT_NEAR(model.accel_scale, 3e-4, 1e-15);
  EXPECT_FALSE(model.is_odometry());
}

TEST(InsErrorModel, GivenFiguresReplaceThoseOfTheGrade) {
  InsOptions options;
  options.grade = InsGrade::kTactical;
  const InsErrorModel tactical = make_ins_error_model(options);
  options.gyro_bias_deg_h = 0;
  const InsErrorModel changed = make_ins_error_model(options);
  EXPECT_GT(tactical.gyro_bias_radps, 0);
  EXPECT_EQ(changed.gyro_bias_radps, 0);
  EXPECT_EQ(changed.accel_bias_mps2, tactical.accel_bias_mps2);
}

TEST(InsErrorModel, EveryGradeHasFigures) {
  for (const auto& [grade, name] : enum_names(InsGrade{})) {
    if (grade == InsGrade::kCustom) continue;
    InsOptions options;
    options.grade = grade;
    EXPECT_NO_THROW(make_ins_error_model(options)) << name;
    EXPECT_EQ(make_ins_error_model(options).is_odometry(), grade == InsGrade::kVisualOdometry);
  }
}

TEST(InsErrorModel, RefusesWhatMakesNoSense) {
  InsOptions options;
  options.grade = InsGrade::kCustom;
  EXPECT_THROW(make_ins_error_model(options), UsageError);
  options.accel_bias_mg = -1;
  EXPECT_THROW(make_ins_error_model(options), UsageError);
  options.accel_bias_mg = 1;
  options.sigma_multiple = 0;
  EXPECT_THROW(make_ins_error_model(options), UsageError);
  options.sigma_multiple = 3;
  options.bias_correlation_s = 0.5;
  EXPECT_THROW(make_ins_error_model(options), UsageError);
}

TEST(InsErrorModel, OptionsHaveJsonNames) {
  InsOptions options;
  set_options_from_json(list_options(options),
                        parse_json("m", R"({"grade": "visual-odometry", "odometry_drift_percent": 2})"), "m");
  EXPECT_NEAR(make_ins_error_model(options).odometry_drift, 0.02, 1e-15);
}

}  // namespace
}  // namespace pilotage
