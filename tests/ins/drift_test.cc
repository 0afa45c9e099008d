#include "pilotage/ins/drift.h"

#include <cmath>

#include "testing/drift_after.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

InsErrorModel model_of(InsGrade grade) {
  InsOptions options;
  options.grade = grade;
  return make_ins_error_model(options);
}

TEST(Drift, BetterGradesDriftLess) {
  const InsGrade grades[] = {InsGrade::kConsumer, InsGrade::kIndustrial, InsGrade::kTactical, InsGrade::kNavigation};
  for (const double time_s : {10.0, 60.0, 300.0}) {
    double last = INFINITY;
    for (const InsGrade grade : grades) {
      const double error = position_error_m(testing::drift_after(model_of(grade), time_s, 20, 2), 1);
      EXPECT_LT(error, last) << time_s;
      EXPECT_GE(error, 2);
      last = error;
    }
  }
}

TEST(Drift, GapIsWhereTheErrorReachesTheLimit) {
  for (const InsGrade grade : {InsGrade::kConsumer, InsGrade::kTactical, InsGrade::kVisualOdometry}) {
    const InsErrorModel model = model_of(grade);
    for (const double limit_m : {8.0, 50.0, 200.0}) {
      const double gap_s = longest_bridgeable_gap_s(model, 20, limit_m, 3, 2);
      ASSERT_GT(gap_s, 0);
      EXPECT_LE(position_error_m(testing::drift_after(model, gap_s, 20, 2), 3), limit_m);
      EXPECT_GT(position_error_m(testing::drift_after(model, gap_s + 0.002, 20, 2), 3), limit_m);
    }
  }
}

// 1 % radial drift is 1/√2 % along each axis: 3σ² = 9 (2² + (0.01 v t)²/2) reaches 50² at t = √2·√(50²/9 − 4)/(0.01 v).
TEST(Drift, OdometryGapHasAClosedForm) {
  InsOptions options;
  options.grade = InsGrade::kCustom;
  options.odometry_drift_percent = 1;
  const double expected_s = std::sqrt(2.0) * std::sqrt(2500.0 / 9 - 4) / (0.01 * 20);
  EXPECT_NEAR(longest_bridgeable_gap_s(make_ins_error_model(options), 20, 50, 3, 2), expected_s, 0.002);
}

TEST(Drift, GapEndsOfTheRange) {
  const InsErrorModel model = model_of(InsGrade::kTactical);
  EXPECT_EQ(longest_bridgeable_gap_s(model, 20, 5, 3, 2), 0) << "three sigma of the fix are 6 m already";
  EXPECT_EQ(longest_bridgeable_gap_s(model, 20, 1e9, 3, 2), kLongestGap_s);
  EXPECT_THROW(longest_bridgeable_gap_s(model, 20, 0, 3, 2), UsageError);
  EXPECT_THROW(longest_bridgeable_gap_s(model, NAN, 50, 3, 2), UsageError);
  // More error allowed, longer gap.
  double last_s = 0;
  for (double limit_m = 7; limit_m < 500; limit_m *= 1.5) {
    const double gap_s = longest_bridgeable_gap_s(model, 20, limit_m, 3, 2);
    EXPECT_GT(gap_s, last_s);
    last_s = gap_s;
  }
}

TEST(SearchRadius, AddsFootprintAndTilt) {
  EXPECT_EQ(search_radius_m(30, 50, 0, 0), 80);
  EXPECT_NEAR(search_radius_m(30, 50, 120, M_PI / 4), 200, 1e-9);
  EXPECT_EQ(search_radius_m(30, 50, 120, 2), INFINITY);
  EXPECT_THROW(search_radius_m(-1, 50, 120, 0), UsageError);
  EXPECT_THROW(search_radius_m(NAN, 50, 120, 0), UsageError);
}

}  // namespace
}  // namespace pilotage
