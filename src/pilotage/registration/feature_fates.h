#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/raster/gray_source.h"
#include "pilotage/registration/surviving_features.h"
#include "pilotage/vision/features.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What a second date says of a feature of the reference.
enum class FeatureFate : std::uint8_t {
  kNotKnown,  ///< The second date does not show all the ground around it, or it is not known where it shows it.
  kSurvives,
  kGone,
};

/// The fates of features of a map, `reference` = extract_features_of_map(…, options). `registered_second` is the second
/// date drawn onto the reference (warped_source.h), CV_8U, on the same grid. It is described, in the feature's octave,
/// at every pixel within kSurvivalRadiusPx of the feature; the feature survives when one of these descriptors differs
/// in at most BinaryDescriptor::survival_distance of the bits. No detector has to find the corner again, as none does
/// in flight (match/frame_grid.h). A feature is not known when the patch of any of these pixels is not all valid or
/// leaves the grid. Reads the blocks that hold features, each once. The same for any number of threads. Throws what the
/// source throws; UsageError as extract_features_of_map.
std::vector<FeatureFate> feature_fates(const FeatureSet& reference, const GraySource& registered_second,
                                       const FeatureOptions& options, int threads = 0);

}  // namespace pilotage

#pragma GCC visibility pop
