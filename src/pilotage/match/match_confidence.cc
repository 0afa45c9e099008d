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

/// What chance gives support to, at kFittedFeaturesPerMpx: onset = level + per_root · √n, scale = width +
/// width_per_root · √n, where n is the number of features that could support. Fitted to the 90 to 99.5 % of frames that
/// show other ground, or ground of their own map beyond the window, the scale then made wider by 1.05 to 1.3: 3,196
/// frames for each of the rows of kGround, at 20,000 and for 128 bits at 40,000 features; ORB's and BRIEF's are those
/// of 4,500 frames and of no border (docs/methods/match-confidence.md). Of a thinner map per_root and width are
/// multiplied by its density to these powers: 1,000 frames at 400 and 1,964 at 2,000 features of 128 bits, the scale
/// wider by 1.2 to 1.9. A power of 0, where nothing was measured, says as much as the denser map does: too little, not
/// too much.
struct SupportTail {
  double level;
  double per_root;
  double width;
  double width_per_root;
  double thin_root_power = 0;
  double thin_width_power = 0;
};

SupportTail support_tail_of(const BinaryDescriptor& descriptor) {
  if (descriptor.pattern != DescriptorPattern::kGround) return {9, 0.88, 3.08, 0.098};
  if (descriptor.bits == 64) return {-1, 2.1, 1.8, 0.12};
  return {1, 1.4, 2.3, 0.11, 0.1, 1.0 / 3};
}

constexpr double kFittedFeaturesPerMpx = 20'000;
/// The thinnest map that was measured.
constexpr double kLeastFeaturesPerMpx = 400;
/// What lies nearer to each other gives support together: the tail of a denser map is that of the features it would
/// have at kFittedFeaturesPerMpx, times the ratio to this power.
constexpr double kDensityPower = 0.75;

Tail support_tail(const PlaceEvidence& evidence) {
  const SupportTail tail = support_tail_of(evidence.descriptor);
  const double expected = std::max(evidence.expected, 0);
  const double density = std::max(evidence.features_per_mpx, kLeastFeaturesPerMpx) / kFittedFeaturesPerMpx;
  if (density < 1) {
    const double root = std::sqrt(expected);
    return {tail.level + tail.per_root * std::pow(density, tail.thin_root_power) * root,
            tail.width * std::pow(density, tail.thin_width_power) + tail.width_per_root * root};
  }
  const double root = std::sqrt(expected / density);
  const double factor = std::pow(density, kDensityPower);
  return {factor * (tail.level + tail.per_root * root), factor * (tail.width + tail.width_per_root * root)};
}

/// Of ncc · √(compared pixels), which is the same for frames of any size.
constexpr Tail kCorrelationTail{7.9, 0.55};
/// Where the frame shows other ground 95 % of the places found by features stay below this correlation; of the right
/// places 1.5 % do. The logarithm of that ratio speaks against them.
constexpr double kNoCorrelation = 5;
constexpr double kAgainst = 4;

double correlation_evidence(double ncc, double compared_px) {
  const double correlation = ncc * std::sqrt(compared_px);
  return correlation < kNoCorrelation ? -kAgainst : kCorrelationTail.exceedance(correlation);
}

/// Of the agreement of directions in windows of kFittedReach positions to each side. Wider ones have as many times more
/// places that may deceive, up to kWidestReach, from where false_fix_rate() counts them.
constexpr Tail kAgreementTail{3.15, 0.57};
constexpr double kFittedReach = 29;
constexpr double kWidestReach = 79;

double agreement_evidence(double agreement, double reach) {
  const double windows = std::pow(std::clamp(reach, kFittedReach, kWidestReach) / kFittedReach, 2);
  return std::max(0.0, kAgreementTail.exceedance(agreement) - std::log(windows));
}

/// How many of those of which the rates were found a search square holds.
double calibrated_windows(double half_width_px) {
  return std::max(1.0, std::pow(half_width_px / kCalibratedHalfWidthPx, 2));
}

}  // namespace

double support_evidence(const PlaceEvidence& evidence) {
  return support_tail(evidence).exceedance(evidence.support);
}

double chance_support(const PlaceEvidence& evidence) {
  return support_tail(evidence).onset;
}

double chip_evidence(const PlaceEvidence& evidence) {
  if (!(evidence.compared_px > 0)) return 0;
  const double of_gray = correlation_evidence(evidence.ncc, evidence.compared_px);
  if (!(evidence.agreement_reach > 0)) return of_gray;
  const double of_directions = agreement_evidence(evidence.agreement, evidence.agreement_reach);
  if (of_gray < 0 && of_directions <= 0) return of_gray;
  return std::max(0.0, std::max(of_gray, of_directions) - std::log(2.0));
}

double place_evidence(const PlaceEvidence& evidence) {
  return std::max(0.0, support_evidence(evidence) + chip_evidence(evidence));
}

double least_lead(double evidence, double rival_evidence) {
  constexpr double kLeast = 3;
  constexpr double kMostOfRival = 8;
  constexpr double kShareOfOwn = 0.2;
  return std::max(kLeast + std::clamp(rival_evidence, 0.0, kMostOfRival), kShareOfOwn * evidence);
}

double false_fix_rate(double evidence, double half_width_px) {
  return std::min(1.0, calibrated_windows(half_width_px) * std::exp(-evidence));
}

double least_evidence(double rate, double half_width_px) {
  return std::log(calibrated_windows(half_width_px) / rate);
}

}  // namespace pilotage
