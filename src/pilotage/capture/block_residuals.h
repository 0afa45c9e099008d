#pragma once

#include <Eigen/Core>
#include <ceres/ceres.h>
#include <ceres/rotation.h>

#include "pilotage/camera/camera.h"

namespace pilotage {

// The residuals of a block's adjustment, each over its standard deviation, as functors of Ceres (AutoDiffCostFunction).
// A pose is a turn (angle axis) against the pose that the round begins with, and the centre: six numbers. A lens is the
// log of the focal length's factor, k1 and k2.

inline constexpr double kBehindSigmas = 1000;

template <class T>
using Vector3 = Eigen::Matrix<T, 3, 1>;

template <class T>
Vector3<T> turned(const T* angle_axis, const Vector3<T>& vector) {
  Vector3<T> result;
  ceres::AngleAxisRotatePoint(angle_axis, vector.data(), result.data());
  return result;
}

/// Where `camera`, with its focal length and k1, k2 from `lens` (log of the factor, k1, k2), sees a point of its own
/// frame. The formulas of camera/lens.h, for Jets.
template <class T>
Eigen::Matrix<T, 2, 1> project(const Camera& camera, const T* lens, const Vector3<T>& point) {
  const T x = point.x() / point.z();
  const T y = point.y() / point.z();
  const T r2 = x * x + y * y;
  const double p1 = camera.distortion[2];
  const double p2 = camera.distortion[3];
  const T radial = 1.0 + r2 * (lens[1] + r2 * (lens[2] + r2 * camera.distortion[4]));
  const T x_distorted = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x);
  const T y_distorted = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y;
  using std::exp;
  const T scale = exp(lens[0]);
  return {scale * camera.fx_px * x_distorted + camera.cx_px, scale * camera.fy_px * y_distorted + camera.cy_px};
}

/// Reprojection error over its standard deviation.
struct SightingError {
  const Camera* camera;
  const Eigen::Matrix3d* camera_from_enu;
  Eigen::Vector2d pixel;
  double sigma_px;

  template <class T>
  bool operator()(const T* pose, const T* point, const T* lens, T* residual) const {
    const Vector3<T> from_center(point[0] - pose[3], point[1] - pose[4], point[2] - pose[5]);
    const Vector3<T> seen = turned<T>(pose, camera_from_enu->cast<T>() * from_center);
    Eigen::Map<Eigen::Matrix<T, 2, 1>> error(residual);
    if (seen.z() < T(1e-6)) {  // behind the camera: an outlier, and no direction to go in
      error.setConstant(T(kBehindSigmas));
      return true;
    }
    error = (project(*camera, lens, seen) - pixel.cast<T>()) / T(sigma_px);
    return true;
  }
};

struct PositionError {
  Eigen::Vector3d measured_m;
  Eigen::Vector3d velocity_mps;
  Eigen::Vector3d sigma_m;

  template <class T>
  bool operator()(const T* pose, const T* bias, const T* clock, T* residual) const {
    for (int axis = 0; axis < 3; ++axis) {
      residual[axis] = (measured_m[axis] + clock[0] * velocity_mps[axis] - bias[axis] - pose[3 + axis]) / sigma_m[axis];
    }
    return true;
  }
};

/// The camera's turn against what was measured, less the boresight, about its own axes.
struct AttitudeError {
  Eigen::Matrix3d camera_from_enu;  ///< Of the pose that the round begins with.
  Eigen::Matrix3d measured_camera_from_enu;
  double tilt_sigma_rad;
  double heading_sigma_rad;

  template <class T>
  bool operator()(const T* pose, const T* boresight, T* residual) const {
    Eigen::Matrix<T, 3, 3> of_pose;
    Eigen::Matrix<T, 3, 3> of_boresight;
    ceres::AngleAxisToRotationMatrix(pose, of_pose.data());
    ceres::AngleAxisToRotationMatrix(boresight, of_boresight.data());
    const Eigen::Matrix<T, 3, 3> turn =
        of_pose * (camera_from_enu * measured_camera_from_enu.transpose()).cast<T>() * of_boresight.transpose();
    T angle_axis[3];
    ceres::RotationMatrixToAngleAxis(turn.data(), angle_axis);
    residual[0] = angle_axis[0] / tilt_sigma_rad;
    residual[1] = angle_axis[1] / tilt_sigma_rad;
    residual[2] = angle_axis[2] / heading_sigma_rad;
    return true;
  }
};

/// An aircraft whose attitude is not known flies level, but for the boresight that all frames share: east and north of
/// its upward axis.
struct LevelError {
  Eigen::Matrix3d camera_from_enu;
  Eigen::Vector3d up_camera;  ///< The aircraft's upward axis in the camera's frame.
  double sigma_rad;

  template <class T>
  bool operator()(const T* pose, const T* boresight, T* residual) const {
    const T back[3] = {-pose[0], -pose[1], -pose[2]};
    const Vector3<T> mounted = turned<T>(boresight, up_camera.cast<T>());
    const Vector3<T> up = camera_from_enu.transpose().cast<T>() * turned<T>(back, mounted);
    residual[0] = up.x() / sigma_rad;
    residual[1] = up.y() / sigma_rad;
    return true;
  }
};

/// Parameters less expected values, over standard deviations.
template <int kSize>
struct PriorError {
  Eigen::Matrix<double, kSize, 1> expected;
  Eigen::Matrix<double, kSize, 1> sigma;

  template <class T>
  bool operator()(const T* values, T* residual) const {
    for (int i = 0; i < kSize; ++i) residual[i] = (values[i] - expected[i]) / sigma[i];
    return true;
  }
};

struct HeightError {
  double expected_m;
  double sigma_m;

  template <class T>
  bool operator()(const T* point, T* residual) const {
    residual[0] = (point[2] - expected_m) / sigma_m;
    return true;
  }
};

/// A point's height over a plane of which nothing is known before (slopes to the east and north, height at the origin):
/// `above_plane_m` above it.
struct PlaneError {
  double above_plane_m;
  double sigma_m;

  template <class T>
  bool operator()(const T* point, const T* plane, T* residual) const {
    residual[0] = (point[2] - plane[0] * point[0] - plane[1] * point[1] - plane[2] - above_plane_m) / sigma_m;
    return true;
  }
};

/// Where a point lies against where another map has it, less what that one misses alike everywhere (east, north).
struct ReferenceError {
  Eigen::Vector2d reference_en_m;
  double sigma_m;

  template <class T>
  bool operator()(const T* point, const T* bias, T* residual) const {
    for (int axis = 0; axis < 2; ++axis) residual[axis] = (point[axis] - reference_en_m[axis] - bias[axis]) / sigma_m;
    return true;
  }
};

struct ScalarError {
  double sigma;

  template <class T>
  bool operator()(const T* value, T* residual) const {
    residual[0] = value[0] / sigma;
    return true;
  }
};

template <int kResiduals, int... kBlocks, class Error>
ceres::CostFunction* cost(const Error& error) {
  return new ceres::AutoDiffCostFunction<Error, kResiduals, kBlocks...>(new Error(error));
}

}  // namespace pilotage
