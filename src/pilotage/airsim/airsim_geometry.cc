#include "pilotage/airsim/airsim_geometry.h"

#include <cmath>

#include <Eigen/Geometry>

#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

/// Turns vectors of our camera frame (x right, y down the image, z along the view) into the simulator's (x along the
/// view, y right, z down the image).
Eigen::Matrix3d airsim_from_camera() {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1,  //
      1, 0, 0,      //
      0, 1, 0;
  return axes;
}

}  // namespace

Eigen::Vector3d ned_from_place(const AirsimHome& home, const AirsimPlace& place) {
  const Eigen::Vector3d enu = LocalFrame(home.point).enu_from_geodetic(place.point);
  return {enu.y(), enu.x(), home.altitude_m - place.altitude_m};
}

AirsimPlace place_from_ned(const AirsimHome& home, const Eigen::Vector3d& ned_m) {
  const LocalFrame frame(home.point);
  // The point of the ellipsoid whose tangent coordinates are north and east: down is found by going there once.
  Eigen::Vector3d enu(ned_m.y(), ned_m.x(), 0);
  for (int i = 0; i < 3; ++i) enu.z() = frame.enu_from_geodetic(frame.geodetic_from_enu(enu)).z();
  return {frame.geodetic_from_enu(enu), home.altitude_m - ned_m.z()};
}

Eigen::Matrix3d rotation_of(const AirsimQuaternion& quaternion) {
  const Eigen::Quaterniond q(static_cast<double>(quaternion.w_val), static_cast<double>(quaternion.x_val),
                             static_cast<double>(quaternion.y_val), static_cast<double>(quaternion.z_val));
  const double length = q.norm();
  if (!std::isfinite(length) || length < 1e-6) return Eigen::Matrix3d::Identity();
  return q.normalized().toRotationMatrix();
}

AirsimQuaternion quaternion_of(const Eigen::Matrix3d& rotation) {
  Eigen::Quaterniond q(rotation);
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  return {static_cast<float>(q.w()), static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z())};
}

AirsimVector airsim_vector(const Eigen::Vector3d& vector) {
  return {static_cast<float>(vector.x()), static_cast<float>(vector.y()), static_cast<float>(vector.z())};
}

Eigen::Vector3d vector_of(const AirsimVector& vector) {
  return {static_cast<double>(vector.x_val), static_cast<double>(vector.y_val), static_cast<double>(vector.z_val)};
}

Eigen::Matrix3d airsim_camera_rotation(const CameraMount& mount) {
  return body_from_camera(mount) * airsim_from_camera().transpose();
}

Attitude attitude_of_camera(const Eigen::Matrix3d& ned_from_airsim_camera) {
  return attitude_of(ned_from_airsim_camera * airsim_from_camera() * body_from_camera({}).transpose());
}

}  // namespace pilotage
