#include "pilotage/matchability/fit_model.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

/// Frames whose outcomes follow z = level + 2·(vote − 5) + 3·(gray + 1) + 0.8·(area − 9).
FitSet drawn_set(const std::string& place, bool anchor, double level, double area, int count, Random& random) {
  FitSet set{place, anchor, {}};
  for (int i = 0; i < count; ++i) {
    const MatchabilityInputs inputs{5 + 0.5 * random.normal(), -1 + 0.3 * random.normal(), area};
    const double z = level + 2 * (inputs.vote_contrast - 5) + 3 * (inputs.gray_contrast + 1) + 0.8 * (area - 9);
    set.samples.push_back({inputs, random.uniform() < 1 / (1 + std::exp(-z))});
  }
  return set;
}

TEST(FitModel, FindsTheFunctionThatOutcomesWereDrawnFrom) {
  Random random(seed_from_name("FindsTheFunction"));
  std::vector<FitSet> sets;
  for (const double area : {8.0, 9.0, 10.0}) {
    sets.push_back(drawn_set("a", true, 0.3, area, 3000, random));
    sets.push_back(drawn_set("b", true, -0.3, area, 3000, random));
    // Flown over in another season: the level of these places must not reach the slopes, nor the level of P.
    sets.push_back(drawn_set("c", false, 1.5, area, 3000, random));
  }
  const MatcherModel model = fit_matcher_model(FlyingMatcher::kFeatures, sets);
  EXPECT_NEAR(model.vote_contrast.coefficient, 2, 0.1);
  EXPECT_NEAR(model.gray_contrast.coefficient, 3, 0.15);
  EXPECT_NEAR(model.area_coefficient, 0.8, 0.08);
  EXPECT_NEAR(model.place_sigma, 0.3, 0.1);
  // At the means of the inputs the anchors' level is 0.
  EXPECT_NEAR(predict_p_correct_fix(model, {5, -1, 9}, 100), 0.5, 0.03);
}

TEST(FitModel, AnchorsSetTheLevelAndOthersTheSlopes) {
  Random random(5);
  std::vector<FitSet> sets;
  for (const double area : {8.0, 10.0}) sets.push_back(drawn_set("others", false, 2, area, 3000, random));
  FitSet anchor = drawn_set("anchor", true, 0, 9, 3000, random);
  for (FitSample& sample : anchor.samples) sample.inputs.vote_contrast = 5 + random.normal();  // says nothing here
  sets.push_back(anchor);
  EXPECT_NEAR(fit_matcher_model(FlyingMatcher::kFeatures, sets).vote_contrast.coefficient, 2, 0.2);
}

TEST(FitModel, AdaptsTheLevelToOnePlaceAndNoMore) {
  Random random(4);
  const MatcherModel model = fit_matcher_model(
      FlyingMatcher::kFeatures, {drawn_set("a", true, 1, 9, 4000, random), drawn_set("b", true, -1, 9, 4000, random)});
  const MatcherModel many = adapt_level(model, {drawn_set("here", false, 1.5, 9, 8000, random)});
  EXPECT_EQ(many.vote_contrast.coefficient, model.vote_contrast.coefficient);
  EXPECT_NEAR(many.intercept - model.intercept, 1.5, 0.15);
  const MatcherModel few = adapt_level(model, {drawn_set("here", false, 1.5, 9, 8, random)});
  EXPECT_LT(std::abs(few.intercept - model.intercept), std::abs(many.intercept - model.intercept))
      << "a handful of tiles must not move it as far";
  EXPECT_THROW(adapt_level(model, {}), DataError);
}

TEST(FitModel, IsTheSameEveryTime) {
  Random random(1);
  const std::vector<FitSet> sets{drawn_set("a", true, 0, 9, 400, random), drawn_set("b", true, 0, 10, 400, random)};
  const MatcherModel one = fit_matcher_model(FlyingMatcher::kFeatures, sets);
  const MatcherModel two = fit_matcher_model(FlyingMatcher::kFeatures, sets);
  EXPECT_EQ(one.intercept, two.intercept);
  EXPECT_EQ(one.vote_contrast.coefficient, two.vote_contrast.coefficient);
}

TEST(FitModel, RefusesTooLittle) {
  Random random(2);
  EXPECT_THROW(fit_matcher_model(FlyingMatcher::kFeatures, {drawn_set("a", true, 0, 9, 60, random)}), DataError);
  EXPECT_THROW(fit_matcher_model(FlyingMatcher::kFeatures, {drawn_set("a", false, 0, 9, 400, random)}), DataError)
      << "no anchor";
}

}  // namespace
}  // namespace pilotage
