#include "pilotage/capture/map_error.h"

#include <cmath>
#include <limits>

#include <Eigen/LU>

namespace pilotage {
namespace {

/// Of the ground, to the east and to the north; level where it is not known around the place.
Eigen::RowVector2d slope_at(const TerrainHeights& heights, const Eigen::Vector2d& en_m) {
  const double step_m = heights.spacing_m() / 2;
  Eigen::RowVector2d slope;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d step = Eigen::Vector2d::Unit(axis) * step_m;
    slope[axis] = (heights.height_m(en_m + step) - heights.height_m(en_m - step)) / (2 * step_m);
  }
  return slope.allFinite() ? slope : Eigen::RowVector2d::Zero();
}

/// How x and y of a pixel's ray (at z = 1) change with the log of the focal length, k1 and k2. The lens's tangential
/// part is left out of the derivatives.
Eigen::Matrix<double, 2, 3> ray_by_lens(const Camera& camera, const Eigen::Vector2d& xy) {
  const double r2 = xy.squaredNorm();
  const auto& k = camera.distortion;  // k1, k2, p1, p2, k3
  const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double per_r2 = k[0] + r2 * (2 * k[1] + r2 * 3 * k[4]);
  const Eigen::Matrix2d distorted_by_ray = radial * Eigen::Matrix2d::Identity() + 2 * per_r2 * xy * xy.transpose();
  Eigen::Matrix<double, 2, 3> distorted_by_lens;
  distorted_by_lens << radial * xy, r2 * xy, r2 * r2 * xy;
  return -distorted_by_ray.inverse() * distorted_by_lens;
}

}  // namespace

Eigen::Matrix2d map_covariance_m2(const AdjustedBlock& block, const GroundSurface& ground, std::size_t frame,
                                  const Eigen::Vector3d& place_enu_m) {
  const FramePose& pose = block.poses[frame];
  const Eigen::Matrix3d camera_from_enu = pose.enu_from_camera.transpose();
  const Eigen::Vector3d ray = camera_from_enu * (place_enu_m - pose.center_enu_m);
  const double down_m = pose.center_enu_m.z() - place_enu_m.z();
  if (!(down_m > 0) || !(ray.z() > 0)) {
    return Eigen::Matrix2d::Identity() * std::numeric_limits<double>::infinity();
  }
  const Eigen::Vector2d from_nadir_m = place_enu_m.head<2>() - pose.center_enu_m.head<2>();
  const Eigen::Vector2d lean = from_nadir_m / -down_m;  // east and north per metre up, along the ray
  // The place that a pixel shows is where its ray meets the ground: lower where the ground falls away.
  const FrameError& error = block.frame_errors[frame];
  const Eigen::RowVector2d slope =
      error.ground_slope ? *error.ground_slope : slope_at(ground.heights, place_enu_m.head<2>());
  const Eigen::Matrix2d along_ground = (Eigen::Matrix2d::Identity() - lean * slope).inverse();
  Eigen::Matrix<double, 2, 3> level;
  level << 1, 0, -lean.x(), 0, 1, -lean.y();
  const Eigen::Matrix<double, 2, 3> onto_ground = along_ground * level;
  Eigen::Matrix3d turned;  // of the ray, by a small turn of the camera
  turned << 0, -ray.z(), ray.y(), ray.z(), 0, -ray.x(), -ray.y(), ray.x(), 0;
  Eigen::Matrix3d zoomed = Eigen::Matrix3d::Zero();
  zoomed.topRows<2>() = ray.z() * ray_by_lens(block.camera, ray.head<2>() / ray.z());
  Eigen::Matrix<double, 2, FrameError::kSize> effect;
  effect.leftCols<3>() = onto_ground * pose.enu_from_camera * turned;
  effect.middleCols<3>(3) = onto_ground;
  effect.middleCols<3>(6) = onto_ground * pose.enu_from_camera * zoomed;
  effect.rightCols<3>() = along_ground * lean * Eigen::RowVector3d(1, from_nadir_m.x(), from_nadir_m.y());
  Eigen::Matrix2d covariance_m2 = effect * error.covariance * effect.transpose();
  const Eigen::Vector2d leaning_m = along_ground * lean * ground.spread_m;
  covariance_m2 += leaning_m * leaning_m.transpose();
  const double pixel_rms_m = block.reprojection_rms_px * ray.z() / block.camera.fx_px;
  covariance_m2.diagonal().array() += pixel_rms_m * pixel_rms_m / 2;  // both axes together
  return covariance_m2;
}

}  // namespace pilotage
