#include "pilotage/ins/ins_span.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

std::vector<InsErrorModel> models() {
  std::vector<InsErrorModel> models;
  for (const InsGrade grade : {InsGrade::kIndustrial, InsGrade::kTactical, InsGrade::kVisualOdometry}) {
    InsOptions options;
    options.grade = grade;
    models.push_back(make_ins_error_model(options));
    models.back().map_sigma_m = 3;
    models.back().map_correlation_m = 300;
  }
  return models;
}

/// A way with turns, changes of speed and steps of several parts.
std::vector<InsStep> way(const InsErrorModel& model) {
  std::vector<InsStep> steps;
  for (const double heading_deg : {90.0, 90.0, 140.0, 95.0}) {
    for (const double dt_s : {0.7, 3.0}) steps.push_back(make_ins_step(dt_s, heading_deg, 20 + dt_s, model));
  }
  return steps;
}

void expect_near(const InsState::Covariance& covariance, const InsState::Covariance& expected, double share) {
  for (int i = 0; i < InsState::kSize; ++i) {
    for (int j = 0; j < InsState::kSize; ++j) {
      const double scale = std::sqrt(expected(i, i) * expected(j, j));
      EXPECT_NEAR(covariance(i, j), expected(i, j), share * scale) << i << ", " << j;
    }
  }
}

TEST(InsSpan, EndsAsFlyingStepByStepDoes) {
  for (const InsErrorModel& model : models()) {
    const InsState begin =
        update_with_fix(propagate(initial_ins_state(model, 80, 20), 30, 80, 20, model), model.fix_sigma_m);
    InsState flown = begin;
    InsSpan span(begin);
    for (const InsStep& step : way(model)) {
      flown = propagate(flown, step);
      span.fly(step);
      const Eigen::Matrix2d position_m2 = span.position().covariance_m2(begin.covariance);
      EXPECT_TRUE(position_m2.isApprox(flown.covariance.topLeftCorner<2, 2>(), 1e-12));
    }
    const InsState end = span.end_of(begin);
    expect_near(end.covariance, flown.covariance, 1e-12);
    EXPECT_EQ(end.covariance, end.covariance.transpose());
    EXPECT_EQ(end.heading_deg, flown.heading_deg);
    EXPECT_EQ(end.speed_mps, flown.speed_mps);
    EXPECT_NEAR(end.time_s, flown.time_s, 1e-12);
    EXPECT_FALSE(span.is_long());
  }
}

TEST(InsSpan, IsFlownAsOneStep) {
  for (const InsErrorModel& model : models()) {
    const InsStep once = make_ins_step(0.7, 80, 20, model);
    InsState state = propagate(initial_ins_state(model, 80, 20), 30, 80, 20, model);
    InsSpan span(state);
    for (int i = 0; i < 5; ++i) span.fly(once);
    const InsState expected = span.end_of(state);
    state = propagate(state, span.as_step());
    EXPECT_EQ(state.covariance, expected.covariance);
    EXPECT_NEAR(state.time_s, expected.time_s, 1e-12);
    EXPECT_EQ(state.heading_deg, 80);
    EXPECT_EQ(state.speed_mps, 20);
  }
}

TEST(InsSpan, FixesWithinItAreThoseOfTheStateThere) {
  for (const InsErrorModel& model : models()) {
    InsState begin = initial_ins_state(model, 80, 20);
    InsState flown = begin;
    InsSpan span(begin);
    const SpanFix at_begin(span, model.fix_sigma_m);
    expect_near(at_begin.fixed(begin.covariance), update_with_fix(begin, model.fix_sigma_m).covariance, 1e-12);
    for (const InsStep& step : way(model)) {
      span.fly(step);
      begin.covariance = SpanFix(span, model.fix_sigma_m).fixed(begin.covariance);
      EXPECT_EQ(begin.covariance, begin.covariance.transpose());
      flown = update_with_fix(propagate(flown, step), model.fix_sigma_m);
    }
    expect_near(span.end_of(begin).covariance, flown.covariance, 1e-9);
  }
}

TEST(InsSpan, LooksAheadAsPropagationDoes) {
  for (const InsErrorModel& model : models()) {
    const InsState begin = initial_ins_state(model, 80, 20);
    InsSpan span(begin);
    for (const InsStep& step : way(model)) span.fly(step);
    const InsStep last = way(model).back();
    const InsStep horizon = make_ins_step(47, last.heading_deg, last.speed_mps, model);
    const Eigen::Matrix2d ahead_m2 = span.position_after(PositionAhead(horizon)).covariance_m2(begin.covariance);
    const InsState later = propagate(span.end_of(begin), horizon);
    EXPECT_TRUE(ahead_m2.isApprox(later.covariance.topLeftCorner<2, 2>(), 1e-12));
  }
}

TEST(InsSpan, IsLongBeforeDigitsAreLost) {
  for (const double correlation_m : {300.0, 40.0}) {
    InsErrorModel model = models().front();
    model.map_correlation_m = correlation_m;
    InsState begin = initial_ins_state(model, 80, 20);
    InsState flown = begin;
    InsSpan span(begin);
    const InsStep step = make_ins_step(5, 80, 20, model);
    int steps = 0;
    for (; !span.is_long(); ++steps) {
      begin.covariance = SpanFix(span, model.fix_sigma_m).fixed(begin.covariance);
      flown = propagate(update_with_fix(flown, model.fix_sigma_m), step);
      span.fly(step);
    }
    EXPECT_GE(steps, 3);
    EXPECT_LE(steps, correlation_m < 100 ? 3 : 13);
    expect_near(span.end_of(begin).covariance, flown.covariance, 1e-7);
  }
}

TEST(InsSpan, AManoeuvreWithoutTimeCounts) {
  const InsErrorModel model = models().front();
  const InsState begin = propagate(initial_ins_state(model, 80, 20), 30, 80, 20, model);
  InsSpan span(begin);
  EXPECT_FALSE(span.is_flown());
  span.fly(make_ins_step(0, 140, 25, model));
  EXPECT_TRUE(span.is_flown());
  const InsState turned = propagate(begin, 0, 140, 25, model);
  expect_near(span.end_of(begin).covariance, turned.covariance, 1e-12);
  EXPECT_EQ(span.end_of(begin).heading_deg, 140);
}

}  // namespace
}  // namespace pilotage
