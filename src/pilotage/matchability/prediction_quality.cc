#include "pilotage/matchability/prediction_quality.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <string>
#include <tuple>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr double kSurest = 1e-6;  // the least probability that log_score knows

/// A prediction in ascending order of value, and how often it counts: 1, or as often as a resample drew its block.
struct Weighted {
  double value = 0;
  bool correct = false;
  std::size_t block = 0;  ///< Counted from 0.
  std::int64_t weight = 1;
};

std::vector<Weighted> sorted(std::span<const JudgedPrediction> predictions) {
  std::map<std::int64_t, std::size_t> block_of;
  for (const JudgedPrediction& prediction : predictions) block_of.try_emplace(prediction.block, block_of.size());
  std::size_t number = 0;
  for (auto& [block, index] : block_of) index = number++;  // in their own order, not that of the predictions
  std::vector<Weighted> list;
  list.reserve(predictions.size());
  for (const JudgedPrediction& prediction : predictions) {
    list.push_back({prediction.value, prediction.correct, block_of[prediction.block], 1});
  }
  // All fields, so that sums are added in one order whatever that of the predictions.
  std::sort(list.begin(), list.end(), [](const Weighted& a, const Weighted& b) {
    return std::tie(a.value, a.block, a.correct) < std::tie(b.value, b.block, b.correct);
  });
  return list;
}

std::int64_t total_weight(std::span<const Weighted> list) {
  std::int64_t total = 0;
  for (const Weighted& each : list) total += each.weight;
  return total;
}

double base_rate(std::span<const Weighted> list) {
  std::int64_t correct = 0;
  for (const Weighted& each : list) correct += each.correct ? each.weight : 0;
  const std::int64_t total = total_weight(list);
  return total > 0 ? static_cast<double>(correct) / static_cast<double>(total) : kNaN;
}

/// Calls `body` with each run of equal values.
template <class Body>
void for_each_tie(std::span<const Weighted> list, Body body) {
  for (std::size_t begin = 0; begin < list.size();) {
    std::size_t end = begin + 1;
    while (end < list.size() && list[end].value == list[begin].value) ++end;
    body(list.subspan(begin, end - begin));
    begin = end;
  }
}

double auc(std::span<const Weighted> list) {
  std::int64_t correct = 0;
  std::int64_t wrong = 0;      // so far: all of lower value
  std::int64_t twice_won = 0;  // pairs in which the correct one is higher, twice, and those that tie
  for_each_tie(list, [&](std::span<const Weighted> equal) {
    std::int64_t correct_here = 0;
    std::int64_t wrong_here = 0;
    for (const Weighted& each : equal) (each.correct ? correct_here : wrong_here) += each.weight;
    twice_won += correct_here * (2 * wrong + wrong_here);
    correct += correct_here;
    wrong += wrong_here;
  });
  if (correct == 0 || wrong == 0) return kNaN;
  return static_cast<double>(twice_won) / 2 / static_cast<double>(correct) / static_cast<double>(wrong);
}

/// Mean over the predictions of loss(value, correct).
template <class Loss>
double mean_loss(std::span<const Weighted> list, Loss loss) {
  double sum = 0;
  for (const Weighted& each : list) sum += static_cast<double>(each.weight) * loss(each.value, each.correct);
  const std::int64_t total = total_weight(list);
  return total > 0 ? sum / static_cast<double>(total) : kNaN;
}

double squared_error(double probability, bool correct) {
  const double error = probability - (correct ? 1 : 0);
  return error * error;
}

double surprise(double probability, bool correct) {
  const double kept = std::clamp(probability, kSurest, 1 - kSurest);
  return -std::log(correct ? kept : 1 - kept);
}

double skill(std::span<const Weighted> list, double reference_rate) {
  const double reference =
      mean_loss(list, [&](double, bool correct) { return squared_error(reference_rate, correct); });
  return reference > 0 ? 1 - mean_loss(list, squared_error) / reference : kNaN;
}

struct Bin {
  double low = 0;
  double high = 0;
  double value_sum = 0;
  double variance_sum = 0;  ///< Of the outcomes if the values are true.
  std::int64_t weight = 0;
  std::int64_t correct = 0;
};

std::vector<Bin> equal_count_bins(std::span<const Weighted> list, int bins) {
  const std::int64_t total = total_weight(list);
  std::vector<Bin> filled;
  Bin bin;
  std::int64_t seen = 0;
  std::int64_t closed = 0;  // how many of the `bins` equal shares are behind
  for_each_tie(list, [&](std::span<const Weighted> equal) {
    if (total_weight(equal) == 0) return;
    if (bin.weight == 0) bin.low = equal.front().value;
    bin.high = equal.front().value;
    for (const Weighted& each : equal) {
      const auto weight = static_cast<double>(each.weight);
      bin.value_sum += weight * each.value;
      bin.variance_sum += weight * each.value * (1 - each.value);
      bin.weight += each.weight;
      bin.correct += each.correct ? each.weight : 0;
      seen += each.weight;
    }
    if (seen * bins / total <= closed) return;
    closed = seen * bins / total;
    filled.push_back(bin);
    bin = {};
  });
  return filled;
}

double calibration_error(std::span<const Weighted> list, int bins) {
  double sum = 0;
  for (const Bin& bin : equal_count_bins(list, bins)) sum += std::abs(bin.value_sum - static_cast<double>(bin.correct));
  const std::int64_t total = total_weight(list);
  return total > 0 ? sum / static_cast<double>(total) : kNaN;
}

/// What the bootstrap gives intervals to.
struct Numbers {
  double auc = kNaN;
  double brier = kNaN;
  double brier_skill = kNaN;
  double brier_skill_stated = kNaN;
  double calibration_error = kNaN;
  double log_score = kNaN;
};

Numbers numbers_of(std::span<const Weighted> list, bool probability, const QualityOptions& options) {
  Numbers numbers;
  numbers.auc = auc(list);
  if (!probability) return numbers;
  numbers.brier = mean_loss(list, squared_error);
  numbers.brier_skill = skill(list, base_rate(list));
  if (!std::isnan(options.stated_rate)) numbers.brier_skill_stated = skill(list, options.stated_rate);
  numbers.calibration_error = calibration_error(list, options.bins);
  numbers.log_score = mean_loss(list, surprise);
  return numbers;
}

std::vector<Numbers> bootstrap(const std::vector<Weighted>& list, std::size_t blocks, bool probability,
                               const QualityOptions& options) {
  std::vector<Numbers> resamples(static_cast<std::size_t>(options.resamples));
  parallel_for(resamples.size(), options.threads, [&](std::size_t index, int) {
    Random random(derive_seed(options.seed, index));
    std::vector<std::int64_t> drawn(blocks, 0);
    for (std::size_t i = 0; i < blocks; ++i) ++drawn[random.below(blocks)];
    std::vector<Weighted> resample = list;
    for (Weighted& each : resample) each.weight = drawn[each.block];
    std::erase_if(resample, [](const Weighted& each) { return each.weight == 0; });
    resamples[index] = numbers_of(resample, probability, options);
  });
  return resamples;
}

Estimate estimate(const Numbers& numbers, const std::vector<Numbers>& resamples, double Numbers::*member,
                  double confidence) {
  std::vector<double> values;
  for (const Numbers& resample : resamples) {
    if (!std::isnan(resample.*member)) values.push_back(resample.*member);
  }
  return {numbers.*member, {quantile(values, (1 - confidence) / 2), quantile(values, (1 + confidence) / 2)}};
}

void require(bool allowed, const std::string& name, double value, const std::string& range) {
  if (!allowed) throw UsageError(name + " = " + format_number(value) + " is outside " + range);
}

void check(const QualityOptions& options) {
  require(options.bins >= 1 && options.bins <= 1000, "bins", options.bins, "[1, 1000]");
  require(options.resamples >= 0 && options.resamples <= 1000000, "resamples", options.resamples, "[0, 1000000]");
  require(options.confidence > 0 && options.confidence < 1, "confidence", options.confidence, "(0, 1)");
  require(std::isnan(options.stated_rate) || (options.stated_rate >= 0 && options.stated_rate <= 1), "stated_rate",
          options.stated_rate, "[0, 1]");
}

std::vector<ReliabilityBin> reliability_bins(std::span<const Weighted> list, int bins) {
  std::vector<ReliabilityBin> result;
  for (const Bin& bin : equal_count_bins(list, bins)) {
    result.push_back({bin.low, bin.high, bin.value_sum / static_cast<double>(bin.weight), {bin.correct, bin.weight}});
  }
  return result;
}

double chance_calibration_error(std::span<const Weighted> list, int bins) {
  if (list.empty()) return kNaN;
  double sum = 0;
  for (const Bin& bin : equal_count_bins(list, bins)) {
    sum += std::sqrt(2 / std::numbers::pi * std::max(0.0, bin.variance_sum));
  }
  return sum / static_cast<double>(total_weight(list));
}

}  // namespace

PredictionQuality judge_predictions(std::span<const JudgedPrediction> predictions, bool probability,
                                    const QualityOptions& options) {
  check(options);
  std::vector<JudgedPrediction> defined;
  for (const JudgedPrediction& prediction : predictions) {
    if (std::isnan(prediction.value)) continue;
    require(!std::isinf(prediction.value), "value", prediction.value, "the finite numbers");
    if (probability) require(prediction.value >= 0 && prediction.value <= 1, "probability", prediction.value, "[0, 1]");
    defined.push_back(prediction);
  }
  const std::vector<Weighted> list = sorted(defined);
  std::size_t blocks = 0;
  for (const Weighted& each : list) blocks = std::max(blocks, each.block + 1);

  PredictionQuality quality;
  quality.count = static_cast<std::int64_t>(defined.size());
  quality.undefined = static_cast<std::int64_t>(predictions.size() - defined.size());
  quality.blocks = static_cast<std::int64_t>(blocks);
  quality.probability = probability;
  quality.correct = std::count_if(defined.begin(), defined.end(), [](const auto& each) { return each.correct; });
  quality.base_rate = base_rate(list);
  quality.bins = reliability_bins(list, options.bins);
  if (probability) quality.chance_calibration_error = chance_calibration_error(list, options.bins);

  const Numbers numbers = numbers_of(list, probability, options);
  const std::vector<Numbers> resamples =
      blocks < 2 ? std::vector<Numbers>{} : bootstrap(list, blocks, probability, options);
  const auto with_interval = [&](double Numbers::*member) {
    return estimate(numbers, resamples, member, options.confidence);
  };
  quality.auc = with_interval(&Numbers::auc);
  quality.brier = with_interval(&Numbers::brier);
  quality.brier_skill = with_interval(&Numbers::brier_skill);
  quality.brier_skill_stated = with_interval(&Numbers::brier_skill_stated);
  quality.calibration_error = with_interval(&Numbers::calibration_error);
  quality.log_score = with_interval(&Numbers::log_score);
  return quality;
}

}  // namespace pilotage
