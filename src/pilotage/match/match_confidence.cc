#include "pilotage/match/match_confidence.h"

#include <algorithm>
#include <cmath>

namespace pilotage {
namespace {

/// The value that the best place of a frame of other ground exceeds with rate exp(−(value − onset)/scale).
struct Tail {
  double onset;
  double scale;
};

constexpr Tail kSupport{32, 3.5};
/// Of ncc · sqrt(compared pixels).
constexpr Tail kCorrelation{7.9, 0.55};

double exceedance(const Tail& tail, double value) { return std::max(0.0, (value - tail.onset) / tail.scale); }

}  // namespace

double place_evidence(const PlaceEvidence& evidence) {
  double sum = exceedance(kSupport, evidence.support);
  if (evidence.compared_px > 0) sum += exceedance(kCorrelation, evidence.ncc * std::sqrt(evidence.compared_px));
  return sum;
}

double false_fix_rate(double evidence, bool chip_compared) {
  return std::min(1.0, std::exp(-(evidence - (chip_compared ? 1.0 : 0.0))));
}

}  // namespace pilotage
