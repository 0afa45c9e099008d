#include "pilotage/matchability/quality_report.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// The higher the worse, over 30 blocks.
JudgedPredictor inverted() {
  std::vector<JudgedPrediction> predictions;
  for (int i = 0; i < 60; ++i) predictions.push_back({i / 60.0, i < 30, i % 30});
  return {"gray_variance", "gray variance", judge_predictions(predictions, false)};
}

// 2 tie groups of 15: 3 and 13 come true; and one that is not defined.
JudgedPredictor good_predictor() {
  std::vector<JudgedPrediction> predictions{{std::numeric_limits<double>::quiet_NaN(), true, 0}};
  for (int i = 0; i < 30; ++i) predictions.push_back({i < 15 ? 0.2 : 0.9, i % 15 < (i < 15 ? 3 : 13), i / 5});
  return {"p_correct_fix", "P(correct fix)", judge_predictions(predictions, true)};
}

TEST(QualityReport, ARowForEachPredictor) {
  const std::vector<JudgedPredictor> predictors{good_predictor(), inverted()};
  const std::string text = quality_markdown(predictors, {});
  // AUC of 2 groups: (13 · 12 + (3 · 12 + 13 · 2) / 2) / (16 · 14).
  EXPECT_THAT(text, HasSubstr("| P(correct fix) | 30 | 53.3 % | 0.835 ("));
  EXPECT_THAT(text, HasSubstr("| gray variance | 60 | 50.0 % | 0.000 ("));
  EXPECT_THAT(text, HasSubstr("gray variance points the wrong way here"));
  EXPECT_THAT(text, Not(HasSubstr("P(correct fix) points")));
  EXPECT_THAT(text, HasSubstr("P(correct fix): not defined for 1 more"));
  EXPECT_THAT(text, HasSubstr("Fewer than 20 blocks"));
  EXPECT_THAT(text, Not(HasSubstr("nan")));
}

TEST(QualityReport, WithoutAProbabilityItsScoresAreNotExplained) {
  const std::vector<JudgedPredictor> predictors{inverted()};
  const std::string text = quality_markdown(predictors, {});
  EXPECT_THAT(text, Not(HasSubstr("**Brier**:")));
  EXPECT_THAT(text, Not(HasSubstr("Fewer than 20 blocks")));
}

TEST(QualityReport, JsonHoldsTheNumbers) {
  const JudgedPredictor predictor = good_predictor();
  const auto json = to_json(predictor);
  EXPECT_EQ(json["name"], "p_correct_fix");
  EXPECT_EQ(json["count"], 30);
  EXPECT_EQ(json["undefined"], 1);
  EXPECT_EQ(json["auc"]["value"], predictor.quality.auc.value);
  EXPECT_EQ(json["auc"]["high"], predictor.quality.auc.interval.high);
  EXPECT_TRUE(json["brier_skill_stated"]["value"].is_null());
  EXPECT_EQ(json["bins"].size(), 2U);
  EXPECT_FALSE(to_json(inverted()).contains("brier"));
}

TEST(QualityReport, EstimatesForPeople) {
  EXPECT_EQ(estimate_text({0.8123, {0.7, 0.91}}, 2), "0.81 (0.70 … 0.91)");
  EXPECT_EQ(estimate_text({0.8123, Estimate{}.interval}, 2), "0.81");
  EXPECT_EQ(estimate_text({}, 2), "–");
}

}  // namespace
}  // namespace pilotage
