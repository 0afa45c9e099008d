#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/vision/feature_set.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// When a feature of the reference counts as found in the second date.
struct SurvivalOptions {
  double radius_px = 1.5;
  double max_share_of_bits = 0.25;  ///< Hamming distance over descriptor length; unrelated patches have about 0.5.
};

/// For each feature of the reference: 1 when the second date, drawn onto the reference, has one within radius_px (in
/// columns and in rows) whose descriptor differs in at most that share of the bits.
std::vector<std::uint8_t> surviving_features(const FeatureSet& reference, const FeatureSet& registered_second,
                                             const SurvivalOptions& options = {});

}  // namespace pilotage

#pragma GCC visibility pop
