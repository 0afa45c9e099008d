#pragma once

#include <array>

#include "pilotage/vision/brief_pattern.h"

namespace pilotage {

/// Length of the longest descriptor of the pattern; shorter ones are its first tests.
inline constexpr int kGroundPatternTests = 256;

/// Half the side of the squares of pixels that a test compares by their sums.
inline constexpr int kGroundBoxRadiusPx = 1;

/// Binary tests that were chosen on ground at two dates, best first (docs/methods/ground-pattern.md says how;
/// studies/learn_ground_pattern.py makes them). They are part of the file format, as the name of the pattern is.
extern const std::array<BriefPair, kGroundPatternTests> kGroundPattern;

}  // namespace pilotage
