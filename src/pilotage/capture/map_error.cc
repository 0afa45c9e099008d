#include "pilotage/capture/map_error.h"

#include <cmath>
#include <limits>

namespace pilotage {

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
  // The place that a pixel shows is where its ray comes to the height of the ground.
  Eigen::Matrix<double, 2, 3> onto_ground;
  onto_ground << 1, 0, -lean.x(), 0, 1, -lean.y();
  const double x = ray.x() / ray.z();
  const double y = ray.y() / ray.z();
  const double r2 = x * x + y * y;
  Eigen::Matrix3d turned;  // of the ray, by a small turn of the camera
  turned << 0, -ray.z(), ray.y(), ray.z(), 0, -ray.x(), -ray.y(), ray.x(), 0;
  // A longer focal length, or barrels that are weaker than thought, put the same pixel nearer to the axis.
  Eigen::Matrix3d zoomed = Eigen::Matrix3d::Zero();
  for (int row = 0; row < 2; ++row) zoomed.row(row) = -ray[row] * Eigen::RowVector3d(1, r2, r2 * r2);
  Eigen::Matrix<double, 2, FrameError::kSize> effect;
  effect.leftCols<3>() = onto_ground * pose.enu_from_camera * turned;
  effect.middleCols<3>(3) = onto_ground;
  effect.middleCols<3>(6) = onto_ground * pose.enu_from_camera * zoomed;
  effect.rightCols<3>() = lean * Eigen::RowVector3d(1, from_nadir_m.x(), from_nadir_m.y());
  Eigen::Matrix2d covariance_m2 = effect * block.frame_errors[frame].covariance * effect.transpose();
  covariance_m2 += ground.spread_m * ground.spread_m * lean * lean.transpose();
  const double pixel_rms_m = block.reprojection_rms_px * ray.z() / block.camera.fx_px;
  covariance_m2.diagonal().array() += pixel_rms_m * pixel_rms_m / 2;  // both axes together
  return covariance_m2;
}

}  // namespace pilotage
