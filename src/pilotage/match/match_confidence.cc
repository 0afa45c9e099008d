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

/// Chance support grows with the number of features that could support: 1,597 frames 80 m wide (about 100 features),
/// 1,650 of 154 m (600) and 1,200 of 260 m (1,600) over maps of other places.
Tail support_tail(int expected) {
  const double root = std::sqrt(static_cast<double>(std::max(expected, 0)));
  return {9 + 0.88 * root, 2.2 + 0.07 * root};
}

/// Of ncc · √(compared pixels), which is the same for frames of any size.
constexpr Tail kCorrelationTail{7.9, 0.55};

}  // namespace

double place_evidence(const PlaceEvidence& evidence) {
  double sum = support_tail(evidence.expected).exceedance(evidence.support);
  if (evidence.compared_px > 0) sum += kCorrelationTail.exceedance(evidence.ncc * std::sqrt(evidence.compared_px));
  return sum;
}

double false_fix_rate(double evidence) { return std::exp(-evidence); }

}  // namespace pilotage
