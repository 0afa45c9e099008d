#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/vision/corner.h"
#include "pilotage/vision/descriptor.h"

namespace pilotage {

/// Upright descriptors of `corners`, `descriptor`.bytes() after bytes. Every corner's patch (BinaryDescriptor::reach_px
/// to each side) must lie inside `gray` (CV_8UC1).
std::vector<std::uint8_t> describe_corners(const cv::Mat& gray, const std::vector<Corner>& corners,
                                           const BinaryDescriptor& descriptor);

}  // namespace pilotage
