#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pilotage/matchability/fit_model.h"
#include "pilotage/matchability/prediction_quality.h"

namespace pilotage {

/// A place as a model predicts it that was fitted without it.
struct PredictedPlace {
  std::string place;
  bool anchor = false;
  std::int64_t tiles = 0;
  std::int64_t correct = 0;
  double p = 0;      ///< Mean P of its tiles, over what the level of a place of its kind may be,
  double p_low = 0;  ///< and where the level lies at the ends of its 80 % interval.
  double p_high = 0;
  double log_score = 0;  ///< Mean of −ln(P of what happened).
  bool held() const {
    const double rate = static_cast<double>(correct) / static_cast<double>(tiles);
    return p_low <= rate && rate <= p_high;
  }
};

/// What P is worth inside places, where the level is known, and across them.
struct PlaceReliability {
  /// Each tile by the model of all places, at the level that was fitted to its own place.
  PredictionQuality inside;
  /// Each tile by a model fitted without its place, its kind (anchor or not) setting the level.
  PredictionQuality across;
  std::vector<PredictedPlace> places;  ///< In the order of their names, anchors last.
};

/// Leave one place out. Blocks of the intervals are places. Kinds with fewer than two places, and places without which
/// nothing can be fitted, are left out of `across`. Throws as fit_matcher_model.
PlaceReliability judge_places(FlyingMatcher matcher, const std::vector<FitSet>& sets,
                              const std::vector<TermChoice>& terms, const QualityOptions& options);

}  // namespace pilotage
