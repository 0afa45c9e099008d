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

/// What chance gives support to, at 20,000 features for each million pixels: onset = level + per_root · √n, scale =
/// width
/// + width_per_root · √n, where n is the number of features that could support. Fitted to the 90 to 99.5 % of frames
/// that show other ground, or ground of their own map beyond the window, the scale then made wider by 1.05 to 1.3:
/// 3,196 frames for each of the rows of kGround, at 20,000 and for 128 bits at 40,000 features; ORB's and BRIEF's are
/// those of 4,500 frames and of no border (docs/methods/match-confidence.md).
struct SupportTail {
  double level;
  double per_root;
  double width;
  double width_per_root;
};

SupportTail support_tail_of(const BinaryDescriptor& descriptor) {
  if (descriptor.pattern != DescriptorPattern::kGround) return {9, 0.88, 3.08, 0.098};
  if (descriptor.bits == 64) return {-1, 2.1, 1.8, 0.12};
  return {1, 1.4, 2.3, 0.11};
}

constexpr double kFittedFeaturesPerMpx = 20'000;
/// What lies nearer to each other gives support together: the tail of a denser map is that of the features it would
/// have at kFittedFeaturesPerMpx, times the ratio to this power.
constexpr double kDensityPower = 0.75;

Tail support_tail(const PlaceEvidence& evidence) {
  const SupportTail tail = support_tail_of(evidence.descriptor);
  const double density = std::max(evidence.features_per_mpx, 1.0) / kFittedFeaturesPerMpx;
  const double root = std::sqrt(std::max(evidence.expected, 0) / density);
  const double factor = std::pow(density, kDensityPower);
  return {factor * (tail.level + tail.per_root * root), factor * (tail.width + tail.width_per_root * root)};
}

/// Of ncc · √(compared pixels), which is the same for frames of any size.
constexpr Tail kCorrelationTail{7.9, 0.55};
/// Where the frame shows other ground 95 % of the places found by features stay below this correlation; of the right
/// places 1.5 % do. The logarithm of that ratio speaks against them.
constexpr double kNoCorrelation = 5;
constexpr double kAgainst = 4;

}  // namespace

double place_evidence(const PlaceEvidence& evidence) {
  double sum = support_tail(evidence).exceedance(evidence.support);
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
