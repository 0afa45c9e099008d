#include "pilotage/matchability/level_at_age.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/nan.h"
#include "pilotage/ground/place_level.h"

namespace pilotage {
namespace {

const PlaceLevel& level_at(const MatchabilityModel& model, std::size_t matcher = 0) {
  return model.matchers[matcher].level;
}

TEST(LevelAtAge, FallsWithTheTimeAndIsLessKnownAwayFromItsOwn) {
  const MatchabilityModel& model = default_matchability_model();
  const PlaceLevel& own = level_at(model);
  const PlaceLevel same = level_at(model_at_age(model, kAgeOfLevel_months));
  EXPECT_DOUBLE_EQ(same.mean, own.mean);
  EXPECT_DOUBLE_EQ(same.sigma, own.sigma);
  const PlaceLevel fresh = level_at(model_at_age(model, kAgeOfLevel_months / std::exp(2)));
  EXPECT_NEAR(fresh.mean, own.mean + 0.8, 1e-12);
  EXPECT_NEAR(fresh.sigma, std::hypot(own.sigma, 0.8), 1e-12);
  const PlaceLevel old = level_at(model_at_age(model, kAgeOfLevel_months * std::exp(1)), 1);
  EXPECT_NEAR(old.mean, level_at(model, 1).mean - 0.4, 1e-12);
  EXPECT_GT(old.sigma, level_at(model, 1).sigma);
}

/// A tile as the default model scores it over imagery of an age.
TileScores scored_at(double age_months, double vote_contrast) {
  const MatchabilityModel model = model_at_age(default_matchability_model(), age_months);
  MatchabilityInputs inputs;
  inputs[ModelInput::kVoteContrast] = vote_contrast;
  const FixPrediction fix = predict_correct_fix(model, FlyingMatcher::kFeatures, inputs, 100);
  TileScores score;
  score.p_correct_fix = fix.p;
  score.level_sigma = fix.level_sigma;
  score.level_age_months = age_months;
  return score;
}

TEST(LevelAtAge, ATileMovesToWhatTheModelSaysAtThatAge) {
  for (const double to_months : {0.1, 3.0, 24.0, 300.0}) {
    TileScores moved = scored_at(10, 3);
    move_to_age(moved, to_months);
    const TileScores scored = scored_at(to_months, 3);
    EXPECT_NEAR(moved.p_correct_fix, scored.p_correct_fix, 1e-9) << to_months;
    EXPECT_NEAR(moved.level_sigma, scored.level_sigma, 1e-9) << to_months;
    EXPECT_EQ(moved.level_age_months, to_months);
  }
  TileScores no_age = scored_at(10, 3);
  no_age.level_age_months = kNaN;
  move_to_age(no_age, 100);
  EXPECT_EQ(no_age.p_correct_fix, scored_at(10, 3).p_correct_fix);
}

TEST(LevelAtAge, ATileIsFoundEverySecondTimeUpToAnAge) {
  TileScores score;
  score.p_correct_fix = 0.62;
  score.level_sigma = 1.6;
  score.level_age_months = 10;
  const double up_to_months = half_found_up_to_months(score).value();
  EXPECT_GT(up_to_months, 10);
  move_to_age(score, up_to_months);
  EXPECT_NEAR(score.p_correct_fix, 0.5, 1e-9);
  EXPECT_NEAR(half_found_up_to_months(score).value(), up_to_months, 1e-6);
  score.p_correct_fix = 0.49;
  EXPECT_FALSE(half_found_up_to_months(score));
  score.p_correct_fix = 0.999;
  EXPECT_EQ(half_found_up_to_months(score), kMostAge_months);
  EXPECT_TRUE(is_half_found_later(score, 1000));
  score.level_age_months = 300;
  EXPECT_FALSE(half_found_up_to_months(score)) << "nothing is known of older imagery";
  score.level_age_months = kNaN;
  EXPECT_FALSE(half_found_up_to_months(score));
}

TEST(LevelAtAge, PromisesNothingForAgesOfWhichNothingIsKnown) {
  const MatchabilityModel& model = default_matchability_model();
  EXPECT_EQ(level_at(model_at_age(model, 0)).mean, level_at(model_at_age(model, kLeastAge_months)).mean);
  EXPECT_EQ(level_at(model_at_age(model, 1000)).mean, level_at(model_at_age(model, kMostAge_months)).mean);
  EXPECT_LT(p_over_level(level_at(model_at_age(model, 0)).mean, level_at(model_at_age(model, 0)).sigma), 0.75);
}

}  // namespace
}  // namespace pilotage
