#include "pilotage/matchability/matchability_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/ground/place_level.h"

namespace pilotage {
namespace {

MatcherModel simple_model() {
  MatcherModel model;
  model.matcher = FlyingMatcher::kFeaturesAndChips;
  model.terms = {{ModelInput::kMapFeatures, 1, 5, 0.5, 3},
                 {ModelInput::kGrayContrast, 0.75, -1, 0.25, 0.5},
                 {ModelInput::kFineContrast, 0.5, 8, 1, 3}};
  model.level = {0.25, 1.5, 1.2, 0.9, 2, 6, 0};
  return model;
}

MatchabilityInputs inputs_of(double map_features, double gray_contrast, double fine_contrast) {
  MatchabilityInputs inputs;
  inputs[ModelInput::kMapFeatures] = map_features;
  inputs[ModelInput::kGrayContrast] = gray_contrast;
  inputs[ModelInput::kFineContrast] = fine_contrast;
  return inputs;
}

double p_of(const MatcherModel& model, const MatchabilityInputs& inputs, double features = 100) {
  return predict_correct_fix(model, inputs, features).p;
}

TileScores scored_tile() {
  TileScores score;
  score.gray_variance = 20;
  score.frieden_deficit = 0.04;  // σ/mean = 0.2: a mean of 100
  score.map_features = 98;
  score.vote_noise = 0.7;
  score.fine_contrast = 1.25;
  return score;
}

TEST(MatchabilityModel, InputsAreThoseOfTheDocumentation) {
  const MatchabilityInputs inputs = matchability_inputs(scored_tile());
  EXPECT_NEAR(inputs[ModelInput::kMapFeatures], std::log(100.0), 1e-12);
  EXPECT_NEAR(inputs[ModelInput::kVoteNoise], std::log(1.0), 1e-12);
  EXPECT_NEAR(inputs[ModelInput::kGrayContrast], std::log(0.21), 1e-12);
  EXPECT_NEAR(inputs[ModelInput::kFineContrast], std::log(1.3), 1e-12);
  EXPECT_NEAR(inputs[ModelInput::kVoteContrast], std::log(100.0), 1e-12);
}

TEST(MatchabilityModel, ContrastCountsAsUsualWhereNothingIsKnownOfTheImagery) {
  TileScores score = scored_tile();
  score.fine_contrast = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(matchability_inputs(score)[ModelInput::kFineContrast], std::log(1.05), 1e-12);
}

TEST(MatchabilityModel, IsTheStatedFunctionOverTheLevel) {
  const double z = 0.25 + 1 * 0.5 + 0.75 * 0.4 + 0.5 * 1;
  EXPECT_NEAR(p_of(simple_model(), inputs_of(5.25, -0.9, 9)), p_over_level(z, 1.5), 1e-12);
  MatcherModel known = simple_model();
  known.level.sigma = 0;
  EXPECT_NEAR(p_of(known, inputs_of(5.25, -0.9, 9)), 1 / (1 + std::exp(-z)), 1e-12);
  const FixPrediction fix = predict_correct_fix(simple_model(), inputs_of(5, -1, 8), 100);
  EXPECT_EQ(fix.level_sigma, 1.5);
  EXPECT_EQ(fix.level_tiles, 0);
}

TEST(MatchabilityModel, NeverPromisesCertaintyWhereTheLevelIsNotKnown) {
  MatcherModel model = simple_model();
  model.level.sigma = 2.5;
  EXPECT_LT(p_of(model, inputs_of(60, 5, 60)), 0.97) << "the most that any ground gets";
}

TEST(MatchabilityModel, PromisesNoMoreThanTheOutermostGroundSeen) {
  const MatcherModel model = simple_model();
  EXPECT_EQ(p_of(model, inputs_of(60, -1, 8)), p_of(model, inputs_of(6.5, -1, 8)));
  EXPECT_EQ(p_of(model, inputs_of(5, 0, 8)), p_of(model, inputs_of(5, -0.875, 8))) << "held at half a spread";
  EXPECT_LT(p_of(model, inputs_of(3, -1, 8)), p_of(model, inputs_of(3.5, -1, 8)))
      << "worse than any seen is worse still";
  MatcherModel falling = model;
  falling.terms = {{ModelInput::kVoteNoise, -1, 0, 1, 2}};
  MatchabilityInputs noisy;
  noisy[ModelInput::kVoteNoise] = 6;
  MatchabilityInputs noisier;
  noisier[ModelInput::kVoteNoise] = 7;
  EXPECT_LT(p_of(falling, noisier), p_of(falling, noisy)) << "it is held where it promises, not where it warns";
}

TEST(MatchabilityModel, FewerFeaturesThanTheMatcherNeedsGiveNothing) {
  EXPECT_EQ(p_of(simple_model(), inputs_of(6, -1, 12), 19), 0);
  EXPECT_GT(p_of(simple_model(), inputs_of(6, -1, 12), 20), 0);
}

TEST(MatchabilityModel, ChipsNeverMakeAFixLessLikely) {
  const MatcherModel chips = simple_model();
  MatcherModel features = simple_model();
  features.matcher = FlyingMatcher::kFeatures;
  features.level.mean -= 1;
  features.level.sigma = 1;
  features.terms[2].coefficient += 2;
  const MatchabilityModel both{"", {}, {}, {features, chips}};
  for (const double relative : {3.0, 10.0}) {
    const MatchabilityInputs inputs = inputs_of(5, -1, relative);
    const FixPrediction fix = predict_correct_fix(both, FlyingMatcher::kFeaturesAndChips, inputs, 100);
    const bool chips_are_better = p_of(chips, inputs) > p_of(features, inputs);
    EXPECT_EQ(fix.p, std::max(p_of(features, inputs), p_of(chips, inputs)));
    EXPECT_EQ(fix.level_sigma, chips_are_better ? 1.5 : 1.0);
    EXPECT_EQ(chips_are_better, relative == 3.0);
    EXPECT_EQ(predict_correct_fix(both, FlyingMatcher::kFeatures, inputs, 100).p, p_of(features, inputs));
  }
  EXPECT_THROW(predict_correct_fix({"", {}, {}, {chips}}, FlyingMatcher::kFeatures, inputs_of(5, -1, 8), 100),
               DataError);
}

TEST(MatchabilityModel, ComesBackFromJson) {
  const MatchabilityModel model{"2026-11-21", {"a", "b"}, {"b"}, {simple_model()}};
  const auto json = matchability_model_to_json(model);
  const MatchabilityModel back = matchability_model_from_json(json, "model.json");
  EXPECT_EQ(matchability_model_to_json(back), json);
  EXPECT_EQ(model_of(back, FlyingMatcher::kFeaturesAndChips).level.sigma, 1.5);
  EXPECT_THROW(model_of(back, FlyingMatcher::kFeatures), DataError);
}

TEST(MatchabilityModel, RefusesWhatIsNotItsFormat) {
  const MatchabilityModel model{"", {}, {}, {simple_model()}};
  auto json = matchability_model_to_json(model);
  json["matchers"][0]["matcher"] = "magic";
  EXPECT_THROW(matchability_model_from_json(json, "m"), DataError);
  json = matchability_model_to_json(model);
  json["matchers"][0]["terms"][1]["spread"] = 0;
  EXPECT_THROW(matchability_model_from_json(json, "m"), DataError);
  json = matchability_model_to_json(model);
  json["matchers"][0]["terms"][1]["input"] = "luck";
  EXPECT_THROW(matchability_model_from_json(json, "m"), DataError);
  json = matchability_model_to_json(model);
  json["format_version"] = 4;
  EXPECT_THROW(matchability_model_from_json(json, "m"), DataError);
  json["format_version"] = 1;
  try {
    matchability_model_from_json(json, "old.json");
    FAIL() << "a model without the spread of its level was taken";
  } catch (const DataError& error) {
    EXPECT_NE(std::string(error.what()).find("old.json"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("pilotage calibrate"), std::string::npos);
  }
}

TEST(MatchabilityModel, TheDefaultDoesNotPromiseFixesOverOrchards) {
  TileScores rows = scored_tile();  // as 111 px of the sample's orchard, where none of 24 frames was found
  rows.map_features = 240;
  rows.vote_noise = 18;
  TileScores town = rows;
  town.vote_noise = 0.3;
  for (const FlyingMatcher matcher : {FlyingMatcher::kFeatures, FlyingMatcher::kFeaturesAndChips}) {
    const auto p = [&](const TileScores& score) {
      return predict_correct_fix(default_matchability_model(), matcher, matchability_inputs(score), score.map_features)
          .p;
    };
    EXPECT_LT(p(rows), 0.25);
    EXPECT_GT(p(town), 0.6);
    town.vote_noise = 5;
    EXPECT_EQ(p(town), p([&] {
                TileScores quiet = town;
                quiet.vote_noise = 0.3;
                return quiet;
              }()))
        << "noise that the true place stands above costs nothing";
    town.vote_noise = 0.3;
  }
}

TEST(MatchabilityModel, TheDefaultHasBothMatchers) {
  for (const FlyingMatcher matcher : {FlyingMatcher::kFeatures, FlyingMatcher::kFeaturesAndChips}) {
    const MatcherModel& model = model_of(default_matchability_model(), matcher);
    // More features and more contrast never make a fix less likely.
    for (const ModelTerm& term : model.terms) {
      EXPECT_EQ(term.coefficient > 0, term.input != ModelInput::kVoteNoise) << model_input_name(term.input);
    }
    EXPECT_GT(model.level.sigma, 0.2);
    EXPECT_GE(model.level.places, 6);
  }
}

TEST(MatchabilityModel, SaysWhatIsLikeTheGroundItWasTestedOn) {
  GridLevel level;
  level.gsd_m = 0.6;
  level.matrix.tile_size_px = 128;
  EXPECT_TRUE(is_like_tested(level));
  for (const auto& [gsd_m, side_px, like] : {std::tuple{0.5, 72, true},
                                             {0.74, 222, true},
                                             {0.6, 71, false},
                                             {0.6, 223, false},
                                             {0.4, 128, false},
                                             {1.0, 128, false}}) {
    level.gsd_m = gsd_m;
    level.matrix.tile_size_px = side_px;
    EXPECT_EQ(is_like_tested(level), like) << gsd_m << " " << side_px;
  }
}

}  // namespace
}  // namespace pilotage
