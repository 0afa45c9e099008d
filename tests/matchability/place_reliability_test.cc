#include "pilotage/matchability/place_reliability.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

/// Places whose levels scatter, with tiles whose outcomes follow z = level + 2·(vote − 5).
std::vector<FitSet> scattered_places(int count, double spread, Random& random) {
  std::vector<FitSet> sets;
  for (int i = 0; i < count; ++i) {
    FitSet set{"place" + std::to_string(10 + i), true, {}};
    const double level = spread * random.normal();
    for (int n = 0; n < 120; ++n) {
      MatchabilityInputs inputs;
      inputs[ModelInput::kMapFeatures] = 5 + random.normal();
      inputs[ModelInput::kVoteContrast] = 5;  // nothing repeats
      const double z = level + 2 * (inputs[ModelInput::kMapFeatures] - 5);
      set.samples.push_back({inputs, random.uniform() < 1 / (1 + std::exp(-z))});
    }
    sets.push_back(set);
  }
  return sets;
}

PlaceReliability judged(const std::vector<FitSet>& sets) {
  QualityOptions options;
  options.resamples = 0;
  return judge_places(FlyingMatcher::kFeatures, sets, {{ModelInput::kMapFeatures, 10}}, options);
}

TEST(PlaceReliability, LevelsMakeItBetterInsidePlacesThanAcrossThem) {
  Random random(3);
  const PlaceReliability reliability = judged(scattered_places(10, 2, random));
  EXPECT_GT(reliability.inside.auc.value, reliability.across.auc.value + 0.03);
  EXPECT_LT(reliability.inside.calibration_error.value, 0.06);
  EXPECT_LT(reliability.inside.log_score.value, reliability.across.log_score.value - 0.05);
  ASSERT_EQ(reliability.places.size(), 10u);
  EXPECT_EQ(reliability.places[4].place, "place14");
  EXPECT_EQ(reliability.places[4].tiles, 120);
  int held = 0;
  for (const PredictedPlace& place : reliability.places) {
    EXPECT_LT(place.p_low, place.p);
    EXPECT_LT(place.p, place.p_high);
    held += place.held() ? 1 : 0;
  }
  EXPECT_GE(held, 5) << "80 % intervals";
}

TEST(PlaceReliability, PlacesThatAreAlikeNeedNoLevel) {
  Random random(5);
  const PlaceReliability reliability = judged(scattered_places(6, 0, random));
  EXPECT_NEAR(reliability.inside.auc.value, reliability.across.auc.value, 0.01);
  EXPECT_LT(reliability.across.calibration_error.value, 0.06);
}

TEST(PlaceReliability, ASinglePlaceHasNoOthers) {
  Random random(6);
  EXPECT_TRUE(judged(scattered_places(1, 0, random)).places.empty());
}

}  // namespace
}  // namespace pilotage
