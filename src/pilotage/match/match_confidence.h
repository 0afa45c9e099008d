#pragma once

namespace pilotage {

/// What speaks for and against the best place.
struct MatchEvidence {
  double support = 0;        ///< GuidedMatch::evidence() of the best place.
  double rival_support = 0;  ///< Of the best place elsewhere.
  int expected = 0;          ///< Features of the map that the frame should show at the best place.
  bool chip_compared = false;
  double ncc = 0;  ///< Of chips at the best place, and the best elsewhere; only when chip_compared.
  double rival_ncc = 0;
};

/// The rate at which the best place of frames that show other ground reaches this evidence, 0 … 1: what is left of the
/// tail of such frames' evidence, an exponential fitted to it (docs/methods/match.md, "Confidence").
double false_fix_rate(const MatchEvidence& evidence);

}  // namespace pilotage
