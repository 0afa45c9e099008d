#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/vision/corner.h"
#include "pilotage/vision/descriptor.h"

namespace pilotage {

/// Angle of the intensity centroid of a disc of 15 px radius around a pixel, degrees in [0, 360), x right, y down (P.
/// L. Rosin, "Measuring corner properties", CVIU 1999; E. Rublee et al., ORB, ICCV 2011, Eq. 1–3). Moments are whole
/// numbers.
float centroid_angle_deg(const cv::Mat& gray, int x, int y);

inline constexpr int kCentroidRadiusPx = 15;

/// Descriptors of `corners` (angles in degrees, one each), `descriptor`.bytes() after bytes. Every corner's patch
/// (patch_radius_px()) must lie inside `gray`.
std::vector<std::uint8_t> describe_corners(const cv::Mat& gray, const std::vector<Corner>& corners,
                                           const std::vector<float>& angles_deg, const BinaryDescriptor& descriptor);

}  // namespace pilotage
