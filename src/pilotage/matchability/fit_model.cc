#include "pilotage/matchability/fit_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include <ceres/ceres.h>

#include "pilotage/base/error.h"
#include "pilotage/ground/place_level.h"

namespace pilotage {
namespace {

constexpr double kSlopeRidge = 0.3;
constexpr std::int64_t kMinOfEach = 50;
constexpr double kSpreadScale = 2.5;  // of the prior of τ
constexpr int kNodes = 21;            // of the integral over a place's level
constexpr int kMiddleNode = kNodes / 2;
constexpr double kNodeStep = 0.5;  // in standard deviations of its posterior

/// A grid of levels, in logits, wide enough for any place: beyond it all fixes come, or none.
constexpr double kLeastLevel = -15;
constexpr double kLevelStep = 0.1;
constexpr std::size_t kLevels = 301;

double level_at(std::size_t i) {
  return kLeastLevel + kLevelStep * static_cast<double>(i);
}

/// ln P(outcome) at a logit; keeps its digits for any.
double log_likelihood(double logit, bool correct) {
  return -std::log1p(std::exp(-std::abs(logit))) - (correct ? std::max(-logit, 0.0) : std::max(logit, 0.0));
}

/// The standardised terms of a place's samples, row after row.
struct Place {
  bool anchor = false;
  std::vector<double> terms;
  std::vector<double> offsets;  ///< What repetition_term() adds to each.
  std::vector<bool> correct;
};

using Slopes = std::vector<double>;

std::vector<double> logits_of(const Place& place, const double* slopes, std::size_t terms) {
  std::vector<double> logits = place.offsets;
  for (std::size_t i = 0; i < logits.size(); ++i) {
    for (std::size_t k = 0; k < terms; ++k) logits[i] += slopes[k] * place.terms[i * terms + k];
  }
  return logits;
}

/// Mode and curvature of ln likelihood + ln N(level; mean, sigma²), by Newton's method; the sum is concave.
LevelPosterior mode_of_level(const LevelPosterior& prior, const std::vector<double>& logits,
                             const std::vector<bool>& correct, double weight) {
  double level = prior.mean;
  double curvature = 0;
  for (int i = 0; i < 100; ++i) {
    const double precision = 1 / (prior.sigma * prior.sigma);
    double slope = (prior.mean - level) * precision;
    curvature = precision;
    for (std::size_t n = 0; n < logits.size(); ++n) {
      const double p = logistic(logits[n] + level);
      slope += weight * ((correct[n] ? 1 : 0) - p);
      curvature += weight * p * (1 - p);
    }
    const double step = std::clamp(slope / curvature, -2.0, 2.0);  // far out the curvature is next to nothing
    level += step;
    if (std::abs(step) < 1e-10) break;
  }
  return {level, 1 / std::sqrt(curvature)};
}

/// −ln marginal likelihood of the slopes, both means and ln τ, with a ridge on the slopes.
class MarginalCost final : public ceres::FirstOrderFunction {
 public:
  MarginalCost(const std::vector<Place>& places, std::size_t terms) : places_(places), terms_(terms) {}

  int NumParameters() const override { return static_cast<int>(terms_) + 3; }

  bool Evaluate(const double* parameters, double* cost, double* gradient) const override {
    *cost = 0;
    if (gradient != nullptr) std::fill_n(gradient, NumParameters(), 0.0);
    for (std::size_t k = 0; k < terms_; ++k) {
      *cost += kSlopeRidge * parameters[k] * parameters[k] / 2;
      if (gradient != nullptr) gradient[k] = kSlopeRidge * parameters[k];
    }
    // A τ of nothing, or without bounds, is no better than one a little less so: the ends are kept off.
    const double log_spread = parameters[terms_ + 2];
    *cost += 0.01 * log_spread * log_spread / 2;
    if (gradient != nullptr) gradient[terms_ + 2] = 0.01 * log_spread;
    for (const Place& place : places_) add(place, parameters, cost, gradient);
    return std::isfinite(*cost);
  }

 private:
  void add(const Place& place, const double* parameters, double* cost, double* gradient) const {
    constexpr double kWeight = 1 / kTilesThatShareGround;
    const std::size_t mean_at = terms_ + (place.anchor ? 0 : 1);
    const LevelPosterior prior{parameters[mean_at], std::exp(parameters[terms_ + 2])};
    const std::vector<double> logits = logits_of(place, parameters, terms_);
    const LevelPosterior mode = mode_of_level(prior, logits, place.correct, kWeight);
    std::array<double, kNodes> level{};
    std::array<double, kNodes> log_density{};
    for (int n = 0; n < kNodes; ++n) {
      level[n] = mode.mean + kNodeStep * (n - kMiddleNode) * mode.sigma;
      const double z = (level[n] - prior.mean) / prior.sigma;
      log_density[n] = -z * z / 2 - std::log(prior.sigma) - std::log(2 * std::numbers::pi) / 2;
      for (std::size_t i = 0; i < logits.size(); ++i) {
        log_density[n] += kWeight * log_likelihood(logits[i] + level[n], place.correct[i]);
      }
    }
    const double highest = *std::max_element(log_density.begin(), log_density.end());
    double sum = 0;
    for (double& density : log_density) sum += density = std::exp(density - highest);
    *cost -= highest + std::log(sum * kNodeStep * mode.sigma);
    if (gradient == nullptr) return;
    for (int n = 0; n < kNodes; ++n) {
      const double share = log_density[n] / sum;
      const double z = (level[n] - prior.mean) / prior.sigma;
      gradient[mean_at] -= share * z / prior.sigma;
      gradient[terms_ + 2] -= share * (z * z - 1);
      for (std::size_t i = 0; i < logits.size(); ++i) {
        const double error = kWeight * (logistic(logits[i] + level[n]) - (place.correct[i] ? 1 : 0));
        for (std::size_t k = 0; k < terms_; ++k) gradient[k] += share * error * place.terms[i * terms_ + k];
      }
    }
  }

  const std::vector<Place>& places_;
  std::size_t terms_;
};

Slopes fit_slopes(const std::vector<Place>& places, std::size_t terms) {
  ceres::GradientProblem problem(new MarginalCost(places, terms));  // the problem owns it
  ceres::GradientProblemSolver::Options options;
  options.max_num_iterations = 500;
  options.function_tolerance = 1e-10;
  options.gradient_tolerance = 1e-6;
  options.logging_type = ceres::SILENT;
  ceres::GradientProblemSolver::Summary summary;
  std::vector<double> parameters(terms + 3, 0.0);
  ceres::Solve(options, problem, parameters.data(), &summary);
  if (!summary.IsSolutionUsable()) throw DataError("the fit did not converge: " + summary.message);
  parameters.resize(terms);
  return parameters;
}

std::vector<ModelTerm> make_terms(const std::vector<FitSet>& sets, const std::vector<TermChoice>& choices) {
  std::vector<ModelTerm> terms;
  for (const TermChoice& choice : choices) {
    double sum = 0;
    double squares = 0;
    double count = 0;
    for (const FitSet& set : sets) {
      for (const FitSample& sample : set.samples) {
        const double x = sample.inputs[choice.input];
        sum += x;
        squares += x * x;
        ++count;
      }
    }
    const double mean = sum / count;
    const double spread = std::max(std::sqrt(std::max(squares / count - mean * mean, 0.0)), 1e-6);
    terms.push_back({choice.input, 1, mean, spread, choice.most});
  }
  return terms;
}

/// The value of one term at a coefficient of `sign`: where it is held depends on which way it points.
double standardised(ModelTerm term, double sign, const MatchabilityInputs& inputs) {
  MatcherModel one;
  term.coefficient = sign;
  one.terms = {term};
  return sign * sum_of_terms(one, inputs);
}

std::vector<Place> places_of(const std::vector<FitSet>& sets, const std::vector<ModelTerm>& terms,
                             const std::vector<double>& signs) {
  MatcherModel repetition;
  repetition.terms = {repetition_term()};
  std::map<std::pair<bool, std::string>, Place> places;
  for (const FitSet& set : sets) {
    if (set.samples.empty()) continue;
    Place& place = places[{set.anchor, set.place}];
    place.anchor = set.anchor;
    for (const FitSample& sample : set.samples) {
      for (std::size_t k = 0; k < terms.size(); ++k) {
        place.terms.push_back(standardised(terms[k], signs[k], sample.inputs));
      }
      place.offsets.push_back(sum_of_terms(repetition, sample.inputs));
      place.correct.push_back(sample.correct);
    }
  }
  std::vector<Place> list;
  for (auto& [name, place] : places) list.push_back(std::move(place));
  return list;
}

/// Likelihood of each level of the grid, its largest being 1.
std::vector<double> likelihood_of_levels(const std::vector<double>& logits, const std::vector<bool>& correct,
                                         double weight) {
  std::vector<double> likelihood(kLevels, 0.0);
  for (std::size_t i = 0; i < kLevels; ++i) {
    for (std::size_t n = 0; n < logits.size(); ++n) {
      likelihood[i] += weight * log_likelihood(logits[n] + level_at(i), correct[n]);
    }
  }
  const double highest = *std::max_element(likelihood.begin(), likelihood.end());
  for (double& value : likelihood) value = std::exp(value - highest);
  return likelihood;
}

/// The normal density of standard deviation `sigma` at 0, 1, … steps of the grid from its mean, times the step.
std::vector<double> normal_steps(double sigma) {
  std::vector<double> density(kLevels);
  for (std::size_t i = 0; i < kLevels; ++i) {
    const double z = kLevelStep * static_cast<double>(i) / sigma;
    density[i] = std::exp(-z * z / 2) * kLevelStep / (sigma * std::sqrt(2 * std::numbers::pi));
  }
  return density;
}

std::size_t apart(std::size_t a, std::size_t b) {
  return a > b ? a - b : b - a;
}

/// ln of the likelihood of each mean of the grid that the levels of places scatter around.
std::vector<double> likelihood_of_means(const std::vector<std::vector<double>>& places,
                                        const std::vector<double>& scatter) {
  std::vector<double> likelihood(kLevels, 0.0);
  for (const std::vector<double>& place : places) {
    for (std::size_t mean = 0; mean < kLevels; ++mean) {
      double sum = 0;
      for (std::size_t i = 0; i < kLevels; ++i) sum += place[i] * scatter[apart(i, mean)];
      likelihood[mean] += std::log(std::max(sum, 1e-300));
    }
  }
  return likelihood;
}

/// The value below which a share of the weights on an ascending grid lies; linear between its points.
double quantile_of(const std::vector<double>& values, const std::vector<double>& weights, double share) {
  double total = 0;
  for (const double weight : weights) total += weight;
  double below = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double step = i + 1 < values.size() ? values[i + 1] - values[i] : values[i] - values[i - 1];
    if (below + weights[i] >= share * total) {
      return values[i] + step * ((share * total - below) / weights[i] - 0.5);
    }
    below += weights[i];
  }
  return values.back();
}

struct LevelDistribution {
  std::vector<double> spreads;
  std::vector<double> of_spreads;
  std::vector<double> of_new_place;
};

LevelDistribution level_distribution(const std::vector<Place>& places, const Slopes& slopes) {
  std::vector<std::vector<double>> anchors;
  std::vector<std::vector<double>> others;
  for (const Place& place : places) {
    const std::vector<double> logits = logits_of(place, slopes.data(), slopes.size());
    (place.anchor ? anchors : others).push_back(likelihood_of_levels(logits, place.correct, 1 / kTilesThatShareGround));
  }
  LevelDistribution result;
  std::vector<std::vector<double>> of_means;
  double highest = -1e300;
  for (double spread = 0.1; spread < 6.05; spread += 0.1) {
    const std::vector<double> scatter = normal_steps(spread);
    std::vector<double> means = likelihood_of_means(anchors, scatter);
    const std::vector<double> means_of_others = likelihood_of_means(others, scatter);
    const double most = *std::max_element(means_of_others.begin(), means_of_others.end());
    double sum = 0;
    for (const double value : means_of_others) sum += std::exp(value - most);
    const double prior = -std::log1p(spread * spread / (kSpreadScale * kSpreadScale));
    for (double& value : means) value += most + std::log(sum) + prior;
    highest = std::max(highest, *std::max_element(means.begin(), means.end()));
    result.spreads.push_back(spread);
    of_means.push_back(std::move(means));
  }
  result.of_new_place.assign(kLevels, 0.0);
  for (std::size_t s = 0; s < result.spreads.size(); ++s) {
    const std::vector<double> scatter = normal_steps(result.spreads[s]);
    double sum = 0;
    for (std::size_t mean = 0; mean < kLevels; ++mean) {
      const double weight = std::exp(of_means[s][mean] - highest);
      sum += weight;
      if (weight < 1e-12) continue;
      for (std::size_t i = 0; i < kLevels; ++i) result.of_new_place[i] += weight * scatter[apart(i, mean)];
    }
    result.of_spreads.push_back(sum);
  }
  return result;
}

PlaceLevel level_of_new_place(const std::vector<Place>& places, const Slopes& slopes) {
  const LevelDistribution known = level_distribution(places, slopes);
  std::vector<double> levels(kLevels);
  for (std::size_t i = 0; i < kLevels; ++i) levels[i] = level_at(i);
  const double low = quantile_of(levels, known.of_new_place, 0.1);
  const double high = quantile_of(levels, known.of_new_place, 0.9);
  PlaceLevel level;
  level.mean = (low + high) / 2;
  level.sigma = (high - low) / 2 / kLevel80_z;
  level.spread = quantile_of(known.spreads, known.of_spreads, 0.5);
  level.spread_low = quantile_of(known.spreads, known.of_spreads, 0.1);
  level.spread_high = quantile_of(known.spreads, known.of_spreads, 0.9);
  level.places =
      static_cast<int>(std::count_if(places.begin(), places.end(), [](const Place& place) { return place.anchor; }));
  return level;
}

void check_sets(const std::vector<FitSet>& sets) {
  std::array<std::int64_t, 2> all{};
  std::array<std::int64_t, 2> of_anchors{};
  for (const FitSet& set : sets) {
    for (const FitSample& sample : set.samples) {
      ++all[sample.correct ? 1 : 0];
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

}  // namespace

ModelTerm repetition_term() {
  constexpr double kLeastContrast = 30;
  constexpr double kSteepness = 6;
  return {ModelInput::kVoteContrast, kSteepness, std::log(kLeastContrast), 1, 0};
}

std::vector<TermChoice> default_terms() {
  return {{ModelInput::kMapFeatures, 3}, {ModelInput::kFineContrast, 3}};
}

MatcherModel fit_matcher_model(FlyingMatcher matcher, const std::vector<FitSet>& sets,
                               const std::vector<TermChoice>& choices) {
  check_sets(sets);
  MatcherModel model;
  model.matcher = matcher;
  model.terms = make_terms(sets, choices);
  // Which way a term points decides at which end it is held: once more where the first fit says another way.
  std::vector<double> signs(choices.size(), 1.0);
  std::vector<Place> places = places_of(sets, model.terms, signs);
  Slopes slopes = fit_slopes(places, choices.size());
  if (std::any_of(slopes.begin(), slopes.end(), [](double slope) { return slope < 0; })) {
    for (std::size_t k = 0; k < signs.size(); ++k) signs[k] = slopes[k] < 0 ? -1 : 1;
    places = places_of(sets, model.terms, signs);
    slopes = fit_slopes(places, choices.size());
  }
  for (std::size_t k = 0; k < slopes.size(); ++k) model.terms[k].coefficient = slopes[k];
  model.terms.push_back(repetition_term());
  model.level = level_of_new_place(places, slopes);
  return model;
}

LevelPosterior level_posterior(const LevelPosterior& prior, const std::vector<double>& logits,
                               const std::vector<bool>& correct, double weight) {
  const LevelPosterior mode = mode_of_level(prior, logits, correct, weight);
  constexpr int kSteps = 80;  // up to eight standard deviations either way
  std::array<double, 2 * kSteps + 1> log_density{};
  double highest = -1e300;
  const auto level = [&](int i) { return mode.mean + 0.1 * i * mode.sigma; };
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double z = (level(i) - prior.mean) / prior.sigma;
    double& value = log_density[static_cast<std::size_t>(i + kSteps)] = -z * z / 2;
    for (std::size_t n = 0; n < logits.size(); ++n) {
      value += weight * log_likelihood(logits[n] + level(i), correct[n]);
    }
    highest = std::max(highest, value);
  }
  double sum = 0;
  double first = 0;
  double second = 0;
  for (int i = -kSteps; i <= kSteps; ++i) {
    const double density = std::exp(log_density[static_cast<std::size_t>(i + kSteps)] - highest);
    sum += density;
    first += density * (level(i) - mode.mean);
    second += density * (level(i) - mode.mean) * (level(i) - mode.mean);
  }
  first /= sum;
  return {mode.mean + first, std::sqrt(std::max(second / sum - first * first, 0.0))};
}

MatcherModel adapt_level(const MatcherModel& model, const std::vector<FitSet>& sets) {
  std::vector<double> logits;
  std::vector<bool> correct;
  for (const FitSet& set : sets) {
    for (const FitSample& sample : set.samples) {
      logits.push_back(sum_of_terms(model, sample.inputs));
      correct.push_back(sample.correct);
    }
  }
  if (logits.empty()) throw DataError("no tile was judged; there is nothing to adapt to");
  const LevelPosterior posterior = level_posterior({model.level.mean, std::max(model.level.sigma, 1e-3)}, logits,
                                                   correct, 1 / kTilesThatShareGround);
  MatcherModel adapted = model;
  adapted.level.mean = posterior.mean;
  adapted.level.sigma = posterior.sigma;
  adapted.level.tiles += static_cast<std::int64_t>(logits.size());
  return adapted;
}

}  // namespace pilotage
