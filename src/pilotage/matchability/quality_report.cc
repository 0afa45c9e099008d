#include "pilotage/matchability/quality_report.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t kFewBlocks = 20;

Json to_json(const Estimate& estimate) {
  return {{"value", json_number(estimate.value)},
          {"low", json_number(estimate.interval.low)},
          {"high", json_number(estimate.interval.high)}};
}

Json to_json(const ReliabilityBin& bin) {
  const Interval interval = bin.correct.interval();
  return {{"low", bin.low},
          {"high", bin.high},
          {"mean_value", bin.mean_value},
          {"count", bin.correct.of},
          {"correct", bin.correct.count},
          {"rate", json_number(bin.correct.value())},
          {"rate_low", interval.low},
          {"rate_high", interval.high}};
}

std::string row(const std::vector<std::string>& cells) {
  return "| " + join(cells, " | ") + " |\n";
}

std::string table(std::span<const JudgedPredictor> predictors, bool with_stated) {
  std::vector<std::string> names{"predictor", "judged", "came true", "AUC", "Brier", "Brier skill"};
  if (with_stated) names.emplace_back("skill, stated rate");
  for (const char* name : {"calibration error", "by chance", "log score"}) names.emplace_back(name);
  std::string text = row(names) + "|---";
  for (std::size_t i = 1; i < names.size(); ++i) text += "|---:";
  text += "|\n";
  for (const JudgedPredictor& predictor : predictors) {
    const PredictionQuality& q = predictor.quality;
    std::vector<std::string> cells{predictor.title,
                                   std::to_string(q.count),
                                   q.count > 0 ? format_fixed(100 * q.base_rate, 1) + " %" : "–",
                                   estimate_text(q.auc, 3),
                                   estimate_text(q.brier, 3),
                                   estimate_text(q.brier_skill, 3)};
    if (with_stated) cells.push_back(estimate_text(q.brier_skill_stated, 3));
    cells.push_back(estimate_text(q.calibration_error, 3));
    cells.push_back(std::isnan(q.chance_calibration_error) ? "–" : format_fixed(q.chance_calibration_error, 3));
    cells.push_back(estimate_text(q.log_score, 3));
    text += row(cells);
  }
  return text;
}

std::string meanings(const QualityOptions& options, bool any_probability) {
  std::string text =
      "- **AUC**: the probability that a place where the fix came out right has the higher value than one where it did "
      "not; 0.5 is worthless. Of all predictors higher values are to mean better places, and none is turned round.\n"
      "- In brackets: " +
      format_number(100 * options.confidence) + " % intervals from " + std::to_string(options.resamples) +
      " resamples of whole blocks, because neighbouring tiles are not independent.\n";
  if (!any_probability) return text;
  return text +
         "- **Brier**: mean squared difference of probability and outcome, 0 is perfect. **Brier skill**: what of it "
         "is "
         "gained over always saying the share that came true; below 0 the predictor is worse than that.\n"
         "- **Calibration error**: mean difference of promise and outcome over " +
         std::to_string(options.bins) +
         " bins of equal count. It is never 0: **by chance** is what probabilities that are all true would show with "
         "as "
         "many independent outcomes.\n"
         "- **Log score**: mean of −ln(probability given to what happened).\n";
}

std::string cautions(std::span<const JudgedPredictor> predictors) {
  std::string text;
  for (const JudgedPredictor& predictor : predictors) {
    const PredictionQuality& q = predictor.quality;
    if (q.auc.interval.high < 0.5) {
      text += "- **" + predictor.title + " points the wrong way here**: its whole interval lies below 0.5.\n";
    }
    if (q.undefined > 0) {
      text += "- " + predictor.title + ": not defined for " + std::to_string(q.undefined) + " more.\n";
    }
    if (q.count > 0 && (q.correct == 0 || q.correct == q.count)) {
      text += "- " + predictor.title + ": all outcomes are alike, so there is nothing to tell apart.\n";
    }
  }
  const bool few = std::any_of(predictors.begin(), predictors.end(), [](const JudgedPredictor& predictor) {
    return predictor.quality.count > 0 && predictor.quality.blocks < kFewBlocks;
  });
  if (few) {
    text += "- Fewer than " + std::to_string(kFewBlocks) +
            " blocks: the intervals are a hint, and rather too narrow. More ground makes them good.\n";
  }
  return text;
}

}  // namespace

std::string estimate_text(const Estimate& estimate, int digits) {
  if (std::isnan(estimate.value)) return "–";
  std::string text = format_fixed(estimate.value, digits);
  if (std::isnan(estimate.interval.low)) return text;
  return text + " (" + format_fixed(estimate.interval.low, digits) + " … " +
         format_fixed(estimate.interval.high, digits) + ")";
}

Json to_json(const JudgedPredictor& predictor) {
  const PredictionQuality& q = predictor.quality;
  Json json{{"name", predictor.name},       {"title", predictor.title},
            {"probability", q.probability}, {"count", q.count},
            {"correct", q.correct},         {"undefined", q.undefined},
            {"blocks", q.blocks},           {"base_rate", json_number(q.base_rate)},
            {"auc", to_json(q.auc)}};
  if (q.probability) {
    json["brier"] = to_json(q.brier);
    json["brier_skill"] = to_json(q.brier_skill);
    json["brier_skill_stated"] = to_json(q.brier_skill_stated);
    json["calibration_error"] = to_json(q.calibration_error);
    json["chance_calibration_error"] = json_number(q.chance_calibration_error);
    json["log_score"] = to_json(q.log_score);
  }
  json["bins"] = Json::array();
  for (const ReliabilityBin& bin : q.bins) json["bins"].push_back(to_json(bin));
  return json;
}

std::string quality_markdown(std::span<const JudgedPredictor> predictors, const QualityOptions& options) {
  const bool any_probability = std::any_of(predictors.begin(), predictors.end(), [](const JudgedPredictor& predictor) {
    return predictor.quality.probability;
  });
  std::string text = table(predictors, !std::isnan(options.stated_rate));
  text += "\n" + meanings(options, any_probability);
  return text + cautions(predictors);
}

}  // namespace pilotage
