#include "pilotage/matchability/level_at_age.h"

#include <cmath>

#include <gtest/gtest.h>

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

TEST(LevelAtAge, PromisesNothingForAgesOfWhichNothingIsKnown) {
  const MatchabilityModel& model = default_matchability_model();
  EXPECT_EQ(level_at(model_at_age(model, 0)).mean, level_at(model_at_age(model, kLeastAge_months)).mean);
  EXPECT_EQ(level_at(model_at_age(model, 1000)).mean, level_at(model_at_age(model, kMostAge_months)).mean);
  EXPECT_LT(p_over_level(level_at(model_at_age(model, 0)).mean, level_at(model_at_age(model, 0)).sigma), 0.75);
}

}  // namespace
}  // namespace pilotage
