#include "pilotage/matchability/fit_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <span>

#include <ceres/ceres.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr double kSlopeRidge = 0.3;
constexpr double kLevelRidge = 0.05;
constexpr double kPlaceRidge = 0.2;
constexpr std::int64_t kMinOfEach = 50;
/// Tiles that overlap succeed and fail together: so many count as one where a level is learned from a single place.
constexpr double kTilesThatShareGround = 4;

/// A row of a logistic regression: which parameters act on it, and how strongly.
struct Row {
  std::array<int, 3> parameter{};
  std::array<double, 3> factor{};
  double offset = 0;
  double weight = 1;
  bool correct = false;
};

/// −Σ w·ln P(outcome) + ½ Σ ridge·p².
class LogisticCost final : public ceres::FirstOrderFunction {
 public:
  LogisticCost(std::vector<Row> rows, std::vector<double> ridge) : rows_(std::move(rows)), ridge_(std::move(ridge)) {}

  int NumParameters() const override { return static_cast<int>(ridge_.size()); }

  bool Evaluate(const double* parameters, double* cost, double* gradient) const override {
    *cost = 0;
    for (std::size_t i = 0; i < ridge_.size(); ++i) {
      *cost += ridge_[i] * parameters[i] * parameters[i] / 2;
      if (gradient != nullptr) gradient[i] = ridge_[i] * parameters[i];
    }
    for (const Row& row : rows_) {
      double z = row.offset;
      for (std::size_t k = 0; k < row.parameter.size(); ++k) z += row.factor[k] * parameters[row.parameter[k]];
      // ln(1 + e^−|z|) keeps its digits for any z.
      *cost += row.weight * (std::log1p(std::exp(-std::abs(z))) + (row.correct ? std::max(-z, 0.0) : std::max(z, 0.0)));
      if (gradient == nullptr) continue;
      const double error = row.weight * (1 / (1 + std::exp(-z)) - (row.correct ? 1.0 : 0.0));
      for (std::size_t k = 0; k < row.parameter.size(); ++k) gradient[row.parameter[k]] += row.factor[k] * error;
    }
    return true;
  }

 private:
  std::vector<Row> rows_;
  std::vector<double> ridge_;
};

std::vector<double> minimise(std::vector<Row> rows, const std::vector<double>& ridge) {
  ceres::GradientProblem problem(new LogisticCost(std::move(rows), ridge));  // the problem owns it
  ceres::GradientProblemSolver::Options options;
  options.max_num_iterations = 1000;
  options.function_tolerance = 1e-12;
  options.gradient_tolerance = 1e-8;
  options.logging_type = ceres::SILENT;
  ceres::GradientProblemSolver::Summary summary;
  std::vector<double> parameters(ridge.size(), 0.0);
  ceres::Solve(options, problem, parameters.data(), &summary);
  if (!summary.IsSolutionUsable()) throw DataError("the fit did not converge: " + summary.message);
  return parameters;
}

ModelTerm mean_and_spread(const std::vector<FitSet>& sets, double MatchabilityInputs::*input) {
  double sum = 0;
  double squares = 0;
  double count = 0;
  for (const FitSet& set : sets) {
    for (const FitSample& sample : set.samples) {
      sum += sample.inputs.*input;
      squares += sample.inputs.*input * (sample.inputs.*input);
      ++count;
    }
  }
  const double mean = sum / count;
  return {0, mean, std::max(std::sqrt(std::max(squares / count - mean * mean, 0.0)), 1e-6)};
}

double standardised(const ModelTerm& term, double x) {
  return std::min((x - term.mean) / term.spread, 3.0);
}

void fit_slopes(const std::vector<FitSet>& sets, MatcherModel& model) {
  std::vector<Row> rows;
  for (std::size_t set = 0; set < sets.size(); ++set) {
    for (const FitSample& sample : sets[set].samples) {
      Row row;
      row.parameter = {0, 1, static_cast<int>(set) + 2};
      row.factor = {standardised(model.vote_contrast, sample.inputs.vote_contrast),
                    standardised(model.gray_contrast, sample.inputs.gray_contrast), 1};
      row.correct = sample.correct;
      rows.push_back(row);
    }
  }
  std::vector<double> ridge(sets.size() + 2, kLevelRidge);
  ridge[0] = ridge[1] = kSlopeRidge;
  const std::vector<double> fitted = minimise(std::move(rows), ridge);
  model.vote_contrast.coefficient = fitted[0] / model.vote_contrast.spread;
  model.gray_contrast.coefficient = fitted[1] / model.gray_contrast.spread;
}

double contrasts_of(const MatcherModel& model, const MatchabilityInputs& inputs) {
  return model.vote_contrast.coefficient * model.vote_contrast.spread *
             standardised(model.vote_contrast, inputs.vote_contrast) +
         model.gray_contrast.coefficient * model.gray_contrast.spread *
             standardised(model.gray_contrast, inputs.gray_contrast);
}

double area_term(const MatcherModel& model, const MatchabilityInputs& inputs) {
  return model.intercept + model.area_coefficient * inputs.described_area;
}

/// Rows whose z is `factors` · parameters + what the model says already; each set weighs as much as a hundred frames.
template <class Factors>
void append_rows(const FitSet& set, const MatcherModel& model, std::array<int, 3> parameters, Factors factors,
                 std::vector<Row>& rows) {
  for (const FitSample& sample : set.samples) {
    Row row;
    row.parameter = parameters;
    row.factor = factors(sample.inputs);
    row.offset = contrasts_of(model, sample.inputs) + area_term(model, sample.inputs);
    row.weight = 100.0 / static_cast<double>(set.samples.size());
    row.correct = sample.correct;
    rows.push_back(row);
  }
}

/// How much more is found in larger frames of the same place, then how much is found at all.
void fit_level(const std::vector<FitSet>& sets, MatcherModel& model) {
  std::map<std::string, std::vector<const FitSet*>> places;
  for (const FitSet& set : sets) {
    if (set.anchor && !set.samples.empty()) places[set.place].push_back(&set);
  }
  constexpr double kUsualArea = 8;  // around it level and area can be told apart
  std::vector<Row> rows;
  int place = 0;
  for (const auto& [name, of_place] : places) {
    ++place;
    const auto factors = [](const MatchabilityInputs& inputs) {
      return std::array<double, 3>{inputs.described_area - kUsualArea, 1, 0};
    };
    for (const FitSet* set : of_place) append_rows(*set, model, {0, place, 0}, factors, rows);
  }
  std::vector<double> ridge(places.size() + 1, kPlaceRidge);
  ridge[0] = 1e-3;
  model.area_coefficient = minimise(std::move(rows), ridge).front();

  const auto level = [](const MatchabilityInputs&) { return std::array<double, 3>{1, 0, 0}; };
  std::vector<Row> all;
  for (const auto& [name, of_place] : places) {
    for (const FitSet* set : of_place) append_rows(*set, model, {}, level, all);
  }
  model.intercept = minimise(std::move(all), {1e-3}).front();

  double squares = 0;
  for (const auto& [name, of_place] : places) {
    std::vector<Row> of_one;
    for (const FitSet* set : of_place) append_rows(*set, model, {}, level, of_one);
    const double off = minimise(std::move(of_one), {kPlaceRidge}).front();
    squares += off * off;
  }
  model.place_sigma = std::sqrt(squares / static_cast<double>(places.size()));
}

void check_sets(const std::vector<FitSet>& of_slopes, const std::vector<FitSet>& sets) {
  std::array<std::int64_t, 2> all{};
  std::array<std::int64_t, 2> of_anchors{};
  for (const FitSet& set : of_slopes) {
    for (const FitSample& sample : set.samples) ++all[sample.correct ? 1 : 0];
  }
  for (const FitSet& set : sets) {
    for (const FitSample& sample : set.samples) {
      if (set.anchor) ++of_anchors[sample.correct ? 1 : 0];
    }
  }
  if (all[0] < kMinOfEach || all[1] < kMinOfEach) {
    throw DataError("only " + std::to_string(all[1]) + " correct fixes and " + std::to_string(all[0]) +
                    " others to fit on; at least " + std::to_string(kMinOfEach) + " of each");
  }
  if (of_anchors[0] == 0 || of_anchors[1] == 0) {
    throw DataError("the anchors have " + std::to_string(of_anchors[1]) + " correct fixes and " +
                    std::to_string(of_anchors[0]) + " others; both must occur");
  }
}

/// What the slopes come from: the sets that set no level, or all where there are no others.
std::vector<FitSet> sets_of_slopes(const std::vector<FitSet>& sets) {
  std::vector<FitSet> others;
  std::copy_if(sets.begin(), sets.end(), std::back_inserter(others), [](const FitSet& set) { return !set.anchor; });
  return others.empty() ? sets : others;
}

}  // namespace

MatcherModel fit_matcher_model(FlyingMatcher matcher, const std::vector<FitSet>& sets) {
  const std::vector<FitSet> of_slopes = sets_of_slopes(sets);
  check_sets(of_slopes, sets);
  MatcherModel model;
  model.matcher = matcher;
  model.vote_contrast = mean_and_spread(of_slopes, &MatchabilityInputs::vote_contrast);
  model.gray_contrast = mean_and_spread(of_slopes, &MatchabilityInputs::gray_contrast);
  fit_slopes(of_slopes, model);
  fit_level(sets, model);
  return model;
}

MatcherModel adapt_level(const MatcherModel& model, const std::vector<FitSet>& sets) {
  std::vector<Row> rows;
  for (const FitSet& set : sets) {
    for (const FitSample& sample : set.samples) {
      Row row;
      row.factor = {1, 0, 0};
      row.offset = contrasts_of(model, sample.inputs) + area_term(model, sample.inputs);
      row.weight = 1.0 / kTilesThatShareGround;
      row.correct = sample.correct;
      rows.push_back(row);
    }
  }
  if (rows.empty()) throw DataError("no tile was judged; there is nothing to adapt to");
  const double sigma = std::max(model.place_sigma, 1e-3);
  MatcherModel adapted = model;
  adapted.intercept += minimise(std::move(rows), {1 / (sigma * sigma)}).front();
  return adapted;
}

}  // namespace pilotage
