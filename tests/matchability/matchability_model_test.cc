#include "pilotage/matchability/matchability_model.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

MatcherModel simple_model() {
  MatcherModel model;
  model.matcher = FlyingMatcher::kFeaturesAndChips;
  model.vote_contrast = {2, 5, 0.5};
  model.gray_contrast = {3, -1, 0.25};
  model.intercept = -4;
  model.area_coefficient = 0.5;
  model.place_sigma = 1.5;
  return model;
}

TileScores scored_tile() {
  TileScores score;
  score.gray_variance = 20;
  score.frieden_deficit = 0.04;  // σ/mean = 0.2: a mean of 100
  score.map_features = 98;
  score.vote_noise = 0.7;
  return score;
}

TEST(MatchabilityModel, InputsAreThoseOfTheDocumentation) {
  const MatchabilityInputs inputs = matchability_inputs(scored_tile(), 132);
  EXPECT_NEAR(inputs.vote_contrast, std::log(100 / 1.0), 1e-12);
  EXPECT_NEAR(inputs.gray_contrast, std::log(0.21), 1e-12);
  EXPECT_NEAR(inputs.described_area, std::log(100.0 * 100.0), 1e-12);
}

TEST(MatchabilityModel, ContrastIsTakenAboveTheBlackOfEightBits) {
  // Gray 60 becomes 0: the mean is 40 then, and σ/mean 0.5.
  EXPECT_NEAR(matchability_inputs(scored_tile(), 132, 60).gray_contrast, std::log(0.51), 1e-12);
}

TEST(MatchabilityModel, IsTheStatedLogisticFunction) {
  const MatchabilityInputs inputs{5.25, -0.9, 8};
  const double z = -4 + 2 * 0.25 + 3 * 0.1 + 0.5 * 8;
  EXPECT_NEAR(predict_p_correct_fix(simple_model(), inputs, 100), 1 / (1 + std::exp(-z)), 1e-12);
}

TEST(MatchabilityModel, PromisesNoMoreThanTheOutermostGroundSeen) {
  const double outermost = predict_p_correct_fix(simple_model(), {6.5, -1, 8}, 100);
  EXPECT_EQ(predict_p_correct_fix(simple_model(), {60, -1, 8}, 100), outermost);
  EXPECT_LT(predict_p_correct_fix(simple_model(), {3, -1, 8}, 100),
            predict_p_correct_fix(simple_model(), {3.5, -1, 8}, 100))
      << "ground worse than any seen is worse still";
}

TEST(MatchabilityModel, FewerFeaturesThanTheMatcherNeedsGiveNothing) {
  EXPECT_EQ(predict_p_correct_fix(simple_model(), {6, -1, 12}, 19), 0);
  EXPECT_GT(predict_p_correct_fix(simple_model(), {6, -1, 12}, 20), 0);
}

TEST(MatchabilityModel, ChipsNeverMakeAFixLessLikely) {
  const MatcherModel chips = simple_model();
  MatcherModel features = simple_model();
  features.matcher = FlyingMatcher::kFeatures;
  features.intercept -= 1;
  features.area_coefficient += 0.2;
  const MatchabilityModel both{"", {}, {}, {features, chips}};
  for (const double area : {3.0, 8.0}) {
    const MatchabilityInputs inputs{5, -1, area};
    const double p = predict_p_correct_fix(both, FlyingMatcher::kFeaturesAndChips, inputs, 100);
    EXPECT_EQ(p, std::max(predict_p_correct_fix(features, inputs, 100), predict_p_correct_fix(chips, inputs, 100)));
    EXPECT_EQ(predict_p_correct_fix(both, FlyingMatcher::kFeatures, inputs, 100),
              predict_p_correct_fix(features, inputs, 100));
  }
  EXPECT_THROW(predict_p_correct_fix({"", {}, {}, {chips}}, FlyingMatcher::kFeatures, {5, -1, 8}, 100), DataError);
}

TEST(MatchabilityModel, ComesBackFromJson) {
  const MatchabilityModel model{"2026-11-21", {"a", "b"}, {"b"}, {simple_model()}};
  const auto json = matchability_model_to_json(model);
  const MatchabilityModel back = matchability_model_from_json(json, "model.json");
  EXPECT_EQ(matchability_model_to_json(back), json);
  EXPECT_EQ(model_of(back, FlyingMatcher::kFeaturesAndChips).place_sigma, 1.5);
  EXPECT_THROW(model_of(back, FlyingMatcher::kFeatures), DataError);
}

TEST(MatchabilityModel, RefusesWhatIsNotItsFormat) {
  const MatchabilityModel model{"", {}, {}, {simple_model()}};
  auto json = matchability_model_to_json(model);
  json["matchers"][0]["matcher"] = "magic";
  EXPECT_THROW(matchability_model_from_json(json, "m"), DataError);
  json = matchability_model_to_json(model);
  json["matchers"][0]["gray_contrast"]["spread"] = 0;
  EXPECT_THROW(matchability_model_from_json(json, "m"), DataError);
  json = matchability_model_to_json(model);
  json["format_version"] = 2;
  EXPECT_THROW(matchability_model_from_json(json, "m"), DataError);
}

TEST(MatchabilityModel, TheDefaultHasBothMatchers) {
  for (const FlyingMatcher matcher : {FlyingMatcher::kFeatures, FlyingMatcher::kFeaturesAndChips}) {
    const MatcherModel& model = model_of(default_matchability_model(), matcher);
    // More votes over noise, more contrast and more ground never make a fix less likely.
    EXPECT_GT(model.vote_contrast.coefficient, 0);
    EXPECT_GT(model.gray_contrast.coefficient, 0);
    EXPECT_GT(model.area_coefficient, 0);
  }
}

}  // namespace
}  // namespace pilotage
