#pragma once

#include <opencv2/core/mat.hpp>

#include "pilotage/match/frame_on_grid.h"
#include "pilotage/vision/feature_options.h"

namespace pilotage {

// Bytes that the steps of a search take at most, estimated from above: what is allocated, and what vectors reserve
// beyond it while they grow. Chips: chip_comparison_bytes().

/// Of MatchOptions::max_memory_mib, in bytes.
inline constexpr double kMib = 1 << 20;

/// To rectify a frame twice, for features and for chips.
double bytes_to_rectify(const cv::Mat& frame);

/// To describe the rectified frame and to search its descriptors.
double bytes_to_describe(const FrameOnGrid& rectified, const FeatureOptions& features);

/// To find the peaks of the votes for a square of this half side; besides what each feature takes.
double bytes_to_vote(double half_width_px);

/// For each feature of the map in the window: itself, and the pairs that it votes with.
double bytes_of_map_feature(const FeatureOptions& features);

}  // namespace pilotage
