#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "rasterise.h"
#include "ring_flight.h"
#include "ring_scene.h"
#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace pilotage::testing {

/// A camera at `from` whose axis goes through `to`.
inline CameraPose looking(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  CameraPose pose;
  pose.position_m = from;
  pose.enu_from_camera.col(2) = (to - from).normalized();
  pose.enu_from_camera.col(0) = pose.enu_from_camera.col(2).cross(Eigen::Vector3d::UnitZ()).normalized();
  pose.enu_from_camera.col(1) = pose.enu_from_camera.col(2).cross(pose.enu_from_camera.col(0));
  return pose;
}

inline Eigen::Vector2d pixel_of(const Eigen::Vector3d& at, const Camera& camera, const CameraPose& pose) {
  const Eigen::Vector3d seen = pose.enu_from_camera.transpose() * (at - pose.position_m);
  return {camera.cx_px + camera.fx_px * seen.x() / seen.z(), camera.cy_px + camera.fy_px * seen.y() / seen.z()};
}

/// Points of the circle in the middle of a ring's tube.
inline std::vector<Eigen::Vector3d> circle_of(const Ring& ring, int count) {
  const Eigen::Vector3d across = direction(ring.azimuth_deg + 90, 0);
  const Eigen::Vector3d up = across.cross(ring.normal());
  std::vector<Eigen::Vector3d> points;
  for (int i = 0; i < count; ++i) {
    const double around = 2 * std::numbers::pi * i / count;
    points.push_back(ring.center_m + (ring.kind().inner_radius_m + ring.kind().tube_radius_m) *
                                         (std::cos(around) * across + std::sin(around) * up));
  }
  return points;
}

inline GroundPicture gray_ground() {
  return make_ground_picture(cv::Mat(64, 64, CV_8UC3, cv::Scalar(110, 120, 100)), {32, 32},
                             Eigen::Matrix2d::Identity());
}

}  // namespace pilotage::testing
