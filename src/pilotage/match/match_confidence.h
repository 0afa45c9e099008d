#pragma once

#include "pilotage/vision/descriptor.h"

namespace pilotage {

/// What speaks for a place.
struct PlaceEvidence {
  double support = 0;                ///< GuidedMatch::evidence().
  int expected = 0;                  ///< Features of the map that the frame should show there.
  BinaryDescriptor descriptor;       ///< Of the map.
  double features_per_mpx = 20'000;  ///< For which the map was built.
  double ncc = 0;                    ///< Correlation with the map's chips there.
  double compared_px = 0;            ///< Pixels of the chips that were compared; 0 without chips.
  double agreement = 0;              ///< DirectionSurface::at() there; 0 where directions were not compared.
  double agreement_reach = 0;        ///< DirectionSurface::reach(); 0 likewise.
};

/// What the support says alone: place_evidence() without chips. At least 0.
double support_evidence(const PlaceEvidence& evidence);

/// The support, of as many expected features, that the best place of frames of other ground has: what chance gives.
double chance_support(const PlaceEvidence& evidence);

/// What the map's chips say for a place, as place_evidence(): the correlation, or the directions of edges if these say
/// more, less ln 2 for having asked both. Negative where both speak against it. 0 without chips.
double chip_evidence(const PlaceEvidence& evidence);

/// How unlikely the evidence is where the frame shows other ground: minus the natural logarithm of the rates at which
/// the best places of such frames reach the support and what chips say, added. The tails are exponentials fitted to
/// frames of other ground (docs/methods/match-confidence.md). At least 0.
double place_evidence(const PlaceEvidence& evidence);

/// The rate at which the best place of frames that show other ground reaches this evidence, in a search square of half
/// side `half_width_px` pixels of the level: exp(−evidence) in one of kCalibratedHalfWidthPx, of which the rates were
/// found, or a smaller one. A larger square has as many times more places that may deceive as it has more ground, and
/// the rate is that many times as high (Boole's inequality), at most 1. Support and chips seldom say much for one
/// and the same wrong place, so their sum needs no correction for being two.
double false_fix_rate(double evidence, double half_width_px);

/// The evidence at which false_fix_rate() is `rate`.
double least_evidence(double rate, double half_width_px);

/// By how much a place must be ahead of the best place elsewhere: 3, and as much again as that has, up to 8, and a
/// fifth of its own evidence. A rival with evidence that other ground hardly ever reaches says that this ground
/// deceives more than that of which the rates were found: rows of trees do (docs/methods/match-confidence.md).
double least_lead(double evidence, double rival_evidence);

/// Windows of 95 m at 0.6 m/px.
inline constexpr double kCalibratedHalfWidthPx = 158;

}  // namespace pilotage
