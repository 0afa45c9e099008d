#include "pilotage/matchability/prediction_quality.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

// Outcomes drawn with the promised probability, one block each.
std::vector<JudgedPrediction> honest_predictions(std::string_view name, int count) {
  Random random(seed_from_name(name));
  std::vector<JudgedPrediction> predictions;
  for (int i = 0; i < count; ++i) {
    const double p = random.uniform();
    predictions.push_back({p, random.uniform() < p, i});
  }
  return predictions;
}

PredictionQuality quality_of(const std::vector<JudgedPrediction>& predictions, bool probability = true, int bins = 10,
                             double stated_rate = kNaN) {
  QualityOptions options;
  options.bins = bins;
  options.stated_rate = stated_rate;
  options.resamples = 0;
  return judge_predictions(predictions, probability, options);
}

double area_under_roc(const std::vector<JudgedPrediction>& predictions) {
  return quality_of(predictions, false).auc.value;
}

double brier_score(const std::vector<JudgedPrediction>& predictions) {
  return quality_of(predictions).brier.value;
}

double brier_skill(const std::vector<JudgedPrediction>& predictions, double reference_rate) {
  return quality_of(predictions, true, 10, reference_rate).brier_skill_stated.value;
}

double log_score(const std::vector<JudgedPrediction>& predictions) {
  return quality_of(predictions).log_score.value;
}

std::vector<ReliabilityBin> reliability_bins(const std::vector<JudgedPrediction>& predictions, int bins) {
  return quality_of(predictions, true, bins).bins;
}

double expected_calibration_error(const std::vector<JudgedPrediction>& predictions, int bins) {
  return quality_of(predictions, true, bins).calibration_error.value;
}

double chance_calibration_error(const std::vector<JudgedPrediction>& predictions, int bins) {
  return quality_of(predictions, true, bins).chance_calibration_error;
}

double auc_over_pairs(const std::vector<JudgedPrediction>& predictions) {
  double won = 0;
  double pairs = 0;
  for (const JudgedPrediction& right : predictions) {
    for (const JudgedPrediction& wrong : predictions) {
      if (!right.correct || wrong.correct) continue;
      ++pairs;
      won += right.value > wrong.value ? 1 : right.value == wrong.value ? 0.5 : 0;
    }
  }
  return won / pairs;
}

TEST(PredictionQuality, AucIsTheShareOfPairsWon) {
  Random random(seed_from_name("AucIsTheShareOfPairsWon"));
  for (const std::uint64_t levels : {2U, 5U, 1000000U}) {  // many ties, some, none
    std::vector<JudgedPrediction> predictions;
    for (int i = 0; i < 200; ++i) {
      const auto value = static_cast<double>(random.below(levels));
      predictions.push_back({value, random.uniform() < 0.3 + 0.4 * value / static_cast<double>(levels), 0});
    }
    EXPECT_NEAR(area_under_roc(predictions), auc_over_pairs(predictions), 1e-12) << levels;
  }
}

TEST(PredictionQuality, AucIsNotTurnedRound) {
  EXPECT_EQ(area_under_roc(std::vector<JudgedPrediction>{{1, false, 0}, {2, false, 0}, {3, true, 0}}), 1);
  EXPECT_EQ(area_under_roc(std::vector<JudgedPrediction>{{1, true, 0}, {2, false, 0}, {3, false, 0}}), 0);
  EXPECT_EQ(area_under_roc(std::vector<JudgedPrediction>{{2, true, 0}, {2, false, 0}}), 0.5);
}

TEST(PredictionQuality, WhatCannotBeToldApartHasNoAuc) {
  EXPECT_TRUE(std::isnan(area_under_roc({})));
  EXPECT_TRUE(std::isnan(area_under_roc(std::vector<JudgedPrediction>{{1, true, 0}, {2, true, 0}})));
  EXPECT_TRUE(std::isnan(brier_score({})));
  EXPECT_TRUE(std::isnan(expected_calibration_error({}, 10)));
}

TEST(PredictionQuality, ScoresByHand) {
  const std::vector<JudgedPrediction> predictions{{0.8, true, 0}, {0.6, false, 0}, {0.1, false, 0}, {1.0, false, 0}};
  EXPECT_NEAR(brier_score(predictions), (0.04 + 0.36 + 0.01 + 1) / 4, 1e-15);
  // Always saying 1/4 earns 3/16; always saying 1/2 earns 1/4.
  EXPECT_NEAR(brier_skill(predictions, 0.25), 1 - 0.3525 / 0.1875, 1e-12);
  EXPECT_NEAR(brier_skill(predictions, 0.5), 1 - 0.3525 / 0.25, 1e-12);
  EXPECT_NEAR(log_score(predictions), -(std::log(0.8) + std::log(0.4) + std::log(0.9) + std::log(1e-6)) / 4, 1e-9);
}

TEST(PredictionQuality, AReferenceThatIsNeverWrongLeavesNoSkill) {
  EXPECT_TRUE(std::isnan(brier_skill(std::vector<JudgedPrediction>{{0.8, true, 0}, {0.9, true, 0}}, 1)));
}

TEST(PredictionQuality, CalibrationErrorByHand) {
  // Five say 0.2 and one of them comes true; five say 0.9 and three come true: |0.2 − 0.2|/2 + |0.9 − 0.6|/2.
  std::vector<JudgedPrediction> predictions;
  for (int i = 0; i < 5; ++i) {
    predictions.push_back({0.2, i < 1, 0});
    predictions.push_back({0.9, i < 3, 0});
  }
  EXPECT_NEAR(expected_calibration_error(predictions, 2), 0.15, 1e-12);
  EXPECT_NEAR(expected_calibration_error(predictions, 10), 0.15, 1e-12) << "equal values were parted";
  EXPECT_NEAR(expected_calibration_error(predictions, 1), 0.15, 1e-12);
}

TEST(PredictionQuality, BinsHaveEqualCountsAndHoldEverything) {
  std::vector<JudgedPrediction> predictions;
  for (int i = 0; i < 103; ++i) predictions.push_back({i / 103.0, i % 3 == 0, 0});
  const std::vector<ReliabilityBin> bins = reliability_bins(predictions, 10);
  ASSERT_EQ(bins.size(), 10U);
  std::int64_t count = 0;
  std::int64_t correct = 0;
  double last = -1;
  for (const ReliabilityBin& bin : bins) {
    EXPECT_GE(bin.correct.of, 10);
    EXPECT_LE(bin.correct.of, 11);
    EXPECT_GT(bin.low, last);
    EXPECT_GE(bin.mean_value, bin.low);
    EXPECT_LE(bin.mean_value, bin.high);
    last = bin.high;
    count += bin.correct.of;
    correct += bin.correct.count;
  }
  EXPECT_EQ(count, 103);
  EXPECT_EQ(correct, 35);
  EXPECT_EQ(reliability_bins(std::vector<JudgedPrediction>(50, {0.4, true, 0}), 10).size(), 1U);
  EXPECT_EQ(reliability_bins(std::vector<JudgedPrediction>{{0.4, true, 0}, {0.5, true, 0}}, 10).size(), 2U);
}

// The formula against what honest predictions really show, over 400 draws of their outcomes.
TEST(PredictionQuality, ChanceAloneGivesTheStatedCalibrationError) {
  std::vector<JudgedPrediction> predictions = honest_predictions("ChanceAlone", 300);
  Random random(seed_from_name("ChanceAloneOutcomes"));
  double sum = 0;
  constexpr int kDraws = 400;
  for (int draw = 0; draw < kDraws; ++draw) {
    for (JudgedPrediction& each : predictions) each.correct = random.uniform() < each.value;
    sum += expected_calibration_error(predictions, 10);
  }
  const double stated = chance_calibration_error(predictions, 10);
  EXPECT_GT(stated, 0.03);
  EXPECT_NEAR(sum / kDraws, stated, 0.05 * stated);
}

// Independent honest predictions with p uniform on [0, 1]: the true Brier score is E p (1 − p) = 1/6 and the true AUC
// P(p₁ > p₀) with densities 2p and 2(1 − p) is 5/6. 95 % intervals from 80 samples must hold the truth about 76 times;
// fewer than 69 has probability 0.002 for honest ones.
TEST(PredictionQuality, IntervalsHoldTheTruthAsOftenAsTheySay) {
  QualityOptions options;
  options.resamples = 300;
  int brier_held = 0;
  int auc_held = 0;
  for (int sample = 0; sample < 80; ++sample) {
    options.seed = static_cast<std::uint64_t>(sample);
    const auto quality =
        judge_predictions(honest_predictions("Intervals" + std::to_string(sample), 250), true, options);
    brier_held += quality.brier.interval.low <= 1.0 / 6 && quality.brier.interval.high >= 1.0 / 6 ? 1 : 0;
    auc_held += quality.auc.interval.low <= 5.0 / 6 && quality.auc.interval.high >= 5.0 / 6 ? 1 : 0;
  }
  EXPECT_GE(brier_held, 69);
  EXPECT_GE(auc_held, 69);
  EXPECT_LT(brier_held + auc_held, 160) << "intervals that always hold are too wide";
}

// Twenty-five copies of each of 40 outcomes hold no more than 40 outcomes do: intervals by block must be as wide as
// those of the 40, not five times as narrow.
TEST(PredictionQuality, CopiesInABlockDoNotNarrowTheInterval) {
  const std::vector<JudgedPrediction> few = honest_predictions("Copies", 40);
  std::vector<JudgedPrediction> copies;
  std::vector<JudgedPrediction> pretended;
  for (const JudgedPrediction& each : few) {
    for (int i = 0; i < 25; ++i) {
      copies.push_back(each);
      pretended.push_back({each.value, each.correct, each.block * 25 + i});
    }
  }
  const auto width = [](const std::vector<JudgedPrediction>& predictions) {
    const Interval interval = judge_predictions(predictions, true).brier.interval;
    return interval.high - interval.low;
  };
  EXPECT_NEAR(width(copies), width(few), 1e-12);
  EXPECT_LT(width(pretended), 0.3 * width(few));
}

void expect_same(const PredictionQuality& a, const PredictionQuality& b) {
  const auto all = [](const PredictionQuality& q) {
    std::vector<double> numbers{q.base_rate, q.chance_calibration_error};
    for (const Estimate* e :
         {&q.auc, &q.brier, &q.brier_skill, &q.brier_skill_stated, &q.calibration_error, &q.log_score}) {
      numbers.insert(numbers.end(), {e->value, e->interval.low, e->interval.high});
    }
    return numbers;
  };
  EXPECT_EQ(all(a), all(b));
}

TEST(PredictionQuality, SameForAnyThreadCountAndOrder) {
  std::vector<JudgedPrediction> predictions = honest_predictions("SameForAny", 200);
  for (JudgedPrediction& each : predictions) {
    each.block /= 10;
    each.value = std::round(each.value * 50) / 50;  // ties
  }
  QualityOptions options;
  options.stated_rate = 0.7;
  options.threads = 1;
  const PredictionQuality one = judge_predictions(predictions, true, options);
  options.threads = 5;
  expect_same(one, judge_predictions(predictions, true, options));
  std::reverse(predictions.begin(), predictions.end());
  expect_same(one, judge_predictions(predictions, true, options));
  options.seed = 2;
  EXPECT_NE(one.auc.interval.low, judge_predictions(predictions, true, options).auc.interval.low);
}

TEST(PredictionQuality, ValuesThatAreNotDefinedAreCountedApart) {
  const std::vector<JudgedPrediction> predictions{{kNaN, true, 1}, {0.9, true, 2}, {0.2, false, 3}};
  const PredictionQuality quality = judge_predictions(predictions, true);
  EXPECT_EQ(quality.count, 2);
  EXPECT_EQ(quality.correct, 1);
  EXPECT_EQ(quality.undefined, 1);
  EXPECT_EQ(quality.blocks, 2);
  EXPECT_EQ(quality.auc.value, 1);
  EXPECT_TRUE(std::isnan(quality.brier_skill_stated.value));
}

TEST(PredictionQuality, AMeasureThatIsNoProbabilityHasOnlyItsAuc) {
  const std::vector<JudgedPrediction> predictions{{45, true, 1}, {20, false, 2}};
  const PredictionQuality quality = judge_predictions(predictions, false);
  EXPECT_EQ(quality.auc.value, 1);
  EXPECT_TRUE(std::isnan(quality.brier.value));
  EXPECT_TRUE(std::isnan(quality.calibration_error.value));
  EXPECT_THROW(judge_predictions(predictions, true), UsageError);
}

TEST(PredictionQuality, OneBlockHasNoInterval) {
  const std::vector<JudgedPrediction> predictions{{0.8, true, 7}, {0.2, false, 7}};
  const PredictionQuality quality = judge_predictions(predictions, true);
  EXPECT_EQ(quality.auc.value, 1);
  EXPECT_TRUE(std::isnan(quality.auc.interval.low));
  EXPECT_EQ(judge_predictions({}, true).count, 0);
}

TEST(PredictionQuality, RefusesWhatIsOutOfRange) {
  const std::vector<JudgedPrediction> none;
  EXPECT_THROW(reliability_bins(none, 0), UsageError);
  EXPECT_THROW(judge_predictions(none, true, {.bins = 0}), UsageError);
  EXPECT_THROW(judge_predictions(none, true, {.resamples = -1}), UsageError);
  EXPECT_THROW(judge_predictions(none, true, {.confidence = 1}), UsageError);
  EXPECT_THROW(judge_predictions(none, true, {.stated_rate = 1.5}), UsageError);
  const std::vector<JudgedPrediction> infinite{{std::numeric_limits<double>::infinity(), true, 0}};
  EXPECT_THROW(judge_predictions(infinite, false), UsageError);
}

}  // namespace
}  // namespace pilotage
