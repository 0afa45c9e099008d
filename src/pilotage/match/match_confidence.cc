#include "pilotage/match/match_confidence.h"

#include <algorithm>
#include <cmath>

namespace pilotage {
namespace {

/// A value exceeds `value` at the best place of a frame of other ground with rate exp(−(value − onset)/scale).
struct Tail {
  double onset;
  double scale;

  double exceedance(double value) const { return std::max(0.0, (value - onset) / scale); }
};

/// Chance support grows with the number of features that could support. The onset is that of frames over maps of other
/// places: 1,597 frames 80 m wide (about 100 features), 1,650 of 154 m (600), 715 of 260 m (2,000). The scale is 1.4
/// times theirs, for ground resembles itself: 2,203 frames over their own map, with priors wrong by more than the
/// window, have the heavier tail.
Tail support_tail(int expected) {
  const double root = std::sqrt(static_cast<double>(std::max(expected, 0)));
  return {9 + 0.88 * root, 1.4 * (2.2 + 0.07 * root)};
}

/// Of ncc · √(compared pixels), which is the same for frames of any size.
constexpr Tail kCorrelationTail{7.9, 0.55};
/// Where the frame shows other ground 95 % of the places found by features stay below this correlation; of the right
/// places 1.5 % do. The logarithm of that ratio speaks against them.
constexpr double kNoCorrelation = 5;
constexpr double kAgainst = 4;

}  // namespace

double place_evidence(const PlaceEvidence& evidence) {
  double sum = support_tail(evidence.expected).exceedance(evidence.support);
  if (evidence.compared_px > 0) {
    const double correlation = evidence.ncc * std::sqrt(evidence.compared_px);
    sum += correlation < kNoCorrelation ? -kAgainst : kCorrelationTail.exceedance(correlation);
  }
  return std::max(0.0, sum);
}

double false_fix_rate(double evidence, double half_width_px) {
  const double windows = std::max(1.0, std::pow(half_width_px / kCalibratedHalfWidthPx, 2));
  return std::min(1.0, windows * std::exp(-evidence));
}

}  // namespace pilotage
