#include "pilotage/matchability/fit_model.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

MatchabilityInputs drawn_inputs(double map_features, double gray_contrast, double fine_contrast) {
  MatchabilityInputs inputs;
  inputs[ModelInput::kMapFeatures] = map_features;
  inputs[ModelInput::kGrayContrast] = gray_contrast;
  inputs[ModelInput::kFineContrast] = fine_contrast;
  inputs[ModelInput::kVoteContrast] = 5;  // nothing repeats
  return inputs;
}

/// Frames whose outcomes follow z = level + 2·(features − 5) + 3·(gray + 1) + 0.8·(relative − 9); four of them look at
/// the same ground and share its fate.
FitSet drawn_set(const std::string& place, bool anchor, double level, double relative, int count, Random& random) {
  FitSet set{place, anchor, {}};
  for (int i = 0; i < count; ++i) {
    const MatchabilityInputs inputs = drawn_inputs(5 + 0.5 * random.normal(), -1 + 0.3 * random.normal(), relative);
    const double z = level + 2 * (inputs[ModelInput::kMapFeatures] - 5) + 3 * (inputs[ModelInput::kGrayContrast] + 1) +
                     0.8 * (relative - 9);
    const FitSample sample{inputs, random.uniform() < 1 / (1 + std::exp(-z))};
    for (int overlapping = 0; overlapping < 4; ++overlapping) set.samples.push_back(sample);
  }
  return set;
}

const std::vector<TermChoice> kFree = {
    {ModelInput::kMapFeatures, 10}, {ModelInput::kGrayContrast, 10}, {ModelInput::kFineContrast, 10}};

double slope_of(const MatcherModel& model, std::size_t term) {
  return model.terms[term].coefficient / model.terms[term].spread;
}

/// z of the model at the means of what drawn_set() draws, at the level it expects.
double expected_level(const MatcherModel& model) {
  return model.level.mean + sum_of_terms(model, drawn_inputs(5, -1, 9));
}

/// Places whose levels are drawn, each seen at three sizes.
std::vector<FitSet> drawn_places(int count, bool anchors, double mean, double spread, int tiles, Random& random) {
  std::vector<FitSet> sets;
  for (int i = 0; i < count; ++i) {
    const double level = mean + spread * random.normal();
    for (const double relative : {8.0, 9.0, 10.0}) {
      sets.push_back(
          drawn_set((anchors ? "anchor" : "other") + std::to_string(i), anchors, level, relative, tiles, random));
    }
  }
  return sets;
}

TEST(FitModel, FindsTheFunctionThatOutcomesWereDrawnFrom) {
  Random random(seed_from_name("FindsTheFunction"));
  std::vector<FitSet> sets = drawn_places(12, true, 0.5, 1.2, 100, random);
  // In another season: how often fixes come there must not reach the level of P.
  for (FitSet& set : drawn_places(12, false, 3, 1.2, 100, random)) sets.push_back(std::move(set));
  const MatcherModel model = fit_matcher_model(FlyingMatcher::kFeatures, sets, kFree);
  EXPECT_NEAR(slope_of(model, 0), 2, 0.2);
  EXPECT_NEAR(slope_of(model, 1), 3, 0.35);
  EXPECT_NEAR(slope_of(model, 2), 0.8, 0.15);
  EXPECT_NEAR(expected_level(model), 0.5, 0.8) << "twelve levels of spread 1.2 tell their mean to 0.35";
  EXPECT_LT(model.level.spread_low, 1.2);
  EXPECT_GT(model.level.spread_high, 1.2);
  EXPECT_GT(model.level.sigma, model.level.spread) << "a new place: as places differ, and the mean is not known";
  EXPECT_LT(model.level.sigma, 1.5 * model.level.spread);
  EXPECT_EQ(model.level.places, 12);
  EXPECT_EQ(model.level.tiles, 0);
}

TEST(FitModel, TheIntervalHoldsFourOfFiveNewPlaces) {
  Random random(seed_from_name("FourOfFive"));
  int held = 0;
  constexpr int kRounds = 40;
  for (int round = 0; round < kRounds; ++round) {
    const double spread = 0.5 + random.uniform();
    const MatcherModel model =
        fit_matcher_model(FlyingMatcher::kFeatures, drawn_places(6, true, 0, spread, 12, random), kFree);
    const double level = spread * random.normal();
    if (std::abs(expected_level(model) - level) < 1.2816 * model.level.sigma) ++held;
  }
  EXPECT_GT(held, 0.8 * kRounds - 7.6) << "of " << kRounds;  // three standard deviations of a binomial number
  EXPECT_LT(held, 0.8 * kRounds + 7.6);
}

TEST(FitModel, FewPlacesTellLittleOfHowTheyDiffer) {
  Random random(7);
  const MatcherModel few = fit_matcher_model(FlyingMatcher::kFeatures, drawn_places(3, true, 0, 1, 60, random), kFree);
  const MatcherModel many =
      fit_matcher_model(FlyingMatcher::kFeatures, drawn_places(24, true, 0, 1, 30, random), kFree);
  EXPECT_GT(few.level.spread_high / few.level.spread_low, 1.5 * many.level.spread_high / many.level.spread_low);
}

TEST(FitModel, AdaptsTheLevelToOnePlaceAndNoMore) {
  Random random(4);
  const MatcherModel model =
      fit_matcher_model(FlyingMatcher::kFeatures, drawn_places(8, true, 0, 1, 60, random), kFree);
  const MatcherModel many = adapt_level(model, {drawn_set("here", false, 1.5, 9, 2000, random)});
  EXPECT_EQ(many.terms[0].coefficient, model.terms[0].coefficient);
  EXPECT_NEAR(expected_level(many), 1.5, 0.2);
  EXPECT_LT(many.level.sigma, 0.15);
  EXPECT_EQ(many.level.tiles, 8000);
  const MatcherModel few = adapt_level(model, {drawn_set("here", false, 1.5, 9, 2, random)});
  EXPECT_LT(few.level.sigma, model.level.sigma);
  EXPECT_GT(few.level.sigma, 5 * many.level.sigma) << "a handful of tiles tells little";
  EXPECT_THROW(adapt_level(model, {}), DataError);
}

TEST(LevelPosterior, AgreesWithAFineGrid) {
  Random random(8);
  for (const double weight : {0.25, 1.0}) {
    for (const bool all_found : {false, true}) {
      std::vector<double> logits;
      std::vector<bool> correct;
      for (int i = 0; i < 12; ++i) {
        logits.push_back(2 * random.normal());
        correct.push_back(all_found || random.uniform() < 0.6);
      }
      const LevelPosterior prior{-1, 2};
      double sum = 0;
      double first = 0;
      double second = 0;
      for (double level = -25; level < 25; level += 1e-3) {
        double density = -(level + 1) * (level + 1) / 8;
        for (std::size_t i = 0; i < logits.size(); ++i) {
          density -= weight * std::log1p(std::exp(correct[i] ? -logits[i] - level : logits[i] + level));
        }
        density = std::exp(density);
        sum += density;
        first += density * level;
        second += density * level * level;
      }
      const LevelPosterior posterior = level_posterior(prior, logits, correct, weight);
      EXPECT_NEAR(posterior.mean, first / sum, 1e-6);
      EXPECT_NEAR(posterior.sigma, std::sqrt(second / sum - first / sum * first / sum), 1e-6);
    }
  }
}

TEST(FitModel, IsTheSameEveryTime) {
  Random random(1);
  const std::vector<FitSet> sets{drawn_set("a", true, 0, 9, 400, random), drawn_set("b", true, 0, 10, 400, random)};
  const MatcherModel one = fit_matcher_model(FlyingMatcher::kFeatures, sets);
  const MatcherModel two = fit_matcher_model(FlyingMatcher::kFeatures, sets);
  EXPECT_EQ(one.level.mean, two.level.mean);
  EXPECT_EQ(one.level.sigma, two.level.sigma);
  EXPECT_EQ(one.terms[0].coefficient, two.terms[0].coefficient);
}

TEST(FitModel, RefusesTooLittle) {
  Random random(2);
  EXPECT_THROW(fit_matcher_model(FlyingMatcher::kFeatures, {drawn_set("a", true, 0, 9, 20, random)}), DataError);
  EXPECT_THROW(fit_matcher_model(FlyingMatcher::kFeatures, {drawn_set("a", false, 0, 9, 400, random)}), DataError)
      << "no anchor";
}

}  // namespace
}  // namespace pilotage
