#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/matchability/matchability_model.h"

namespace pilotage {

/// One judged frame.
struct FitSample {
  MatchabilityInputs inputs;
  bool correct = false;
};

/// The judged frames of one place, all of one size on the ground.
struct FitSet {
  std::string place;
  bool anchor = false;  ///< Its share of correct fixes is one that flights can expect.
  std::vector<FitSample> samples;
};

/// Fits a MatcherModel by penalised maximum likelihood (ceres::GradientProblemSolver, L-BFGS), in two steps.
///
/// 1. The slopes of the two contrasts, with a level of its own for each set: what is learned is which ground of a place
///    is found more often than the rest of it, and not that one place was flown over in a better season. From the sets
///    that are no anchors, or from all where there are no others. Slopes have a ridge of 0.3 on standardised inputs,
///    levels one of 0.05.
/// 2. On the anchors, the slopes held and each set with the same weight: the area coefficient with a level for each
///    place, then the one intercept that gives all of them their mean rate. place_sigma is the root mean square of what
///    their places' levels are off from it.
///
/// Deterministic. Throws DataError when there is no anchor, when the anchors have a single outcome, or when step 1 has
/// fewer than 50 samples of either outcome.
MatcherModel fit_matcher_model(FlyingMatcher matcher, const std::vector<FitSet>& sets);

/// The model for one place where a second date has been judged: the intercept moves to what was found there, held back
/// by the prior that places differ by place_sigma; four tiles count as one, because neighbours share ground. Nothing
/// else changes. Throws DataError when there is no sample.
MatcherModel adapt_level(const MatcherModel& model, const std::vector<FitSet>& sets);

}  // namespace pilotage
