#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/raster/gray_source.h"
#include "pilotage/vision/features.h"

namespace pilotage {

/// What a second date says of a feature of the reference.
enum class FeatureFate : std::uint8_t {
  kNotKnown,  ///< The second date does not show all the ground around it, or it is not known where it shows it.
  kSurvives,
  kGone,
};

/// The fates of features of a map, `reference` = extract_features_of_map(…, windows, options). `registered_second` is
/// the second date drawn onto the reference (warped_source.h), CV_8U, on the same grid; its own features are found with
/// the same options. A feature survives as surviving_features says, and is not known when any pixel that its
/// counterpart could depend on is not valid. Only blocks near the windows are read; the fate of a feature does not
/// depend on the other windows, nor on the number of threads. Throws as extract_features_of_map.
std::vector<FeatureFate> feature_fates(const FeatureSet& reference, const std::vector<PixelWindow>& windows,
                                       const GraySource& registered_second, const FeatureOptions& options,
                                       int threads = 0);

}  // namespace pilotage
