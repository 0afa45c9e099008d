#pragma once

#include <cstddef>

#include <Eigen/Core>

#include "pilotage/capture/ground_surface.h"

namespace pilotage {

/// Covariance, east and north (m²), of where a map of the block shows the ground at `place_enu_m` (of the surface) from
/// `frame`: what the adjustment leaves unknown of the frame's pose, the lens and the ground below it, together; relief
/// that the surface leaves out, which leans away from the camera by its height over the slope of the ray; and how well
/// the frames' pixels fit together. Modelled, to first order in all of them. Infinite for a place that is not below
/// the camera.
Eigen::Matrix2d map_covariance_m2(const AdjustedBlock& block, const GroundSurface& ground, std::size_t frame,
                                  const Eigen::Vector3d& place_enu_m);

}  // namespace pilotage
