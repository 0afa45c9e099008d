#include "pilotage/matchability/place_reliability.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "pilotage/base/error.h"
#include "pilotage/ground/place_level.h"

namespace pilotage {
namespace {

using PlaceName = std::pair<bool, std::string>;  // anchors last

PlaceName name_of_place(const FitSet& set) {
  return {set.anchor, set.place};
}

/// The sets of the other places; those of the kind of the one that is left out set the level.
std::vector<FitSet> without(const std::vector<FitSet>& sets, const PlaceName& left_out) {
  std::vector<FitSet> others;
  for (const FitSet& set : sets) {
    if (name_of_place(set) == left_out) continue;
    others.push_back(set);
    others.back().anchor = set.anchor == left_out.first;
  }
  return others;
}

/// P of a place's tiles, added to `predictions`; the tiles' mean is given back.
PredictedPlace predict_place(const MatcherModel& model, const PlaceName& name, const std::vector<FitSet>& sets,
                             std::int64_t block, std::vector<JudgedPrediction>& predictions) {
  PredictedPlace place{name.second, name.first};
  for (const FitSet& set : sets) {
    if (name_of_place(set) != name) continue;
    for (const FitSample& sample : set.samples) {
      const double logit = model.level.mean + sum_of_terms(model, sample.inputs);
      const double p = p_over_level(logit, model.level.sigma);
      place.p += p;
      place.p_low += logistic(logit - kLevel80_z * model.level.sigma);
      place.p_high += logistic(logit + kLevel80_z * model.level.sigma);
      place.log_score -= std::log(std::max(sample.correct ? p : 1 - p, 1e-6));
      ++place.tiles;
      place.correct += sample.correct ? 1 : 0;
      predictions.push_back({p, sample.correct, block});
    }
  }
  for (double* sum : {&place.p, &place.p_low, &place.p_high, &place.log_score})
    *sum /= static_cast<double>(place.tiles);
  return place;
}

/// At the level that the place's own outcomes give; its spread is so wide that they alone decide.
void predict_inside(const MatcherModel& model, const PlaceName& name, const std::vector<FitSet>& sets,
                    std::int64_t block, std::vector<JudgedPrediction>& predictions) {
  std::vector<double> logits;
  std::vector<bool> correct;
  for (const FitSet& set : sets) {
    if (name_of_place(set) != name) continue;
    for (const FitSample& sample : set.samples) {
      logits.push_back(sum_of_terms(model, sample.inputs));
      correct.push_back(sample.correct);
    }
  }
  const LevelPosterior level =
      level_posterior({model.level.mean, model.level.spread}, logits, correct, 1 / kTilesThatShareGround);
  for (std::size_t i = 0; i < logits.size(); ++i) {
    predictions.push_back({p_over_level(level.mean + logits[i], level.sigma), correct[i], block});
  }
}

}  // namespace

PlaceReliability judge_places(FlyingMatcher matcher, const std::vector<FitSet>& sets,
                              const std::vector<TermChoice>& terms, const QualityOptions& options) {
  std::map<PlaceName, std::int64_t> blocks;
  std::array<int, 2> of_kind{};
  for (const FitSet& set : sets) {
    if (set.samples.empty()) continue;
    if (blocks.emplace(name_of_place(set), 0).second) ++of_kind[set.anchor ? 1 : 0];
  }
  std::int64_t count = 0;
  for (auto& [name, block] : blocks) block = count++;

  PlaceReliability result;
  const MatcherModel of_all = fit_matcher_model(matcher, sets, terms);
  std::vector<JudgedPrediction> inside;
  std::vector<JudgedPrediction> across;
  for (const auto& [name, block] : blocks) {
    predict_inside(of_all, name, sets, block, inside);
    if (of_kind[name.first ? 1 : 0] < 2) continue;
    try {
      const MatcherModel of_others = fit_matcher_model(matcher, without(sets, name), terms);
      result.places.push_back(predict_place(of_others, name, sets, block, across));
    } catch (const DataError&) {
      continue;  // nothing can be fitted on the others
    }
  }
  result.inside = judge_predictions(inside, true, options);
  result.across = judge_predictions(across, true, options);
  return result;
}

}  // namespace pilotage
