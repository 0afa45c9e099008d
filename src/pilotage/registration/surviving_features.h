#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/vision/feature_set.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A feature of the reference counts as found in the second date within this many pixels, in columns and in rows, where
/// the descriptors differ in at most BinaryDescriptor::survival_distance of their bits.
inline constexpr double kSurvivalRadiusPx = 1.5;

/// For each feature of the reference: 1 when it is found among those of the second date, drawn onto the reference.
std::vector<std::uint8_t> surviving_features(const FeatureSet& reference, const FeatureSet& registered_second);

}  // namespace pilotage

#pragma GCC visibility pop
