#include "pilotage/vision/brief_pattern.h"

#include <cmath>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

constexpr int kHalfPatchPx = kBriefPatchPx / 2;
constexpr double kSigmaPx = kBriefPatchPx / 5.0;  // variance S²/25

std::int8_t draw_offset(Random& random) {
  while (true) {
    const double offset = std::round(kSigmaPx * random.normal());
    if (std::abs(offset) <= kHalfPatchPx) return static_cast<std::int8_t>(offset);
  }
}

}  // namespace

std::vector<BriefPair> make_brief_pattern(int bits, std::uint64_t seed) {
  Random random(seed);
  std::vector<BriefPair> pattern;
  while (pattern.size() < static_cast<std::size_t>(bits)) {
    BriefPair pair{};
    pair.x1 = draw_offset(random);
    pair.y1 = draw_offset(random);
    pair.x2 = draw_offset(random);
    pair.y2 = draw_offset(random);
    if (pair.x1 != pair.x2 || pair.y1 != pair.y2) pattern.push_back(pair);
  }
  return pattern;
}

}  // namespace pilotage
