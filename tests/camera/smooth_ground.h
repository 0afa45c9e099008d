#pragma once

#include <array>
#include <cmath>

#include <Eigen/Core>

#include "pilotage/camera/camera.h"

namespace pilotage::testing {

/// Smooth ground with structure of 7 m and more: gray as a function of east and north, metres.
inline double smooth_ground_gray(const Eigen::Vector2d& p) {
  return 128 + 35 * std::sin(p.x() * 0.9 + 0.3) * std::cos(p.y() * 0.7) + 30 * std::sin(0.31 * p.x() - 0.53 * p.y()) +
         25 * std::cos(0.11 * p.x() + 0.17 * p.y());
}

/// The camera with a lens that bends.
inline Camera distorted(Camera camera, DistortionModel model, const std::array<double, 5>& distortion) {
  camera.distortion_model = model;
  camera.distortion = distortion;
  return camera;
}

}  // namespace pilotage::testing
