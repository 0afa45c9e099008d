#include "pilotage/match/match_confidence.h"

#include <algorithm>
#include <cmath>

namespace pilotage {

double false_fix_rate(const MatchEvidence& evidence) {
  return std::min(1.0, std::exp(-(evidence.support - 40) / 10));
}

}  // namespace pilotage
