#include "pilotage/camera/attitude.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "pilotage/base/angle.h"

namespace pilotage {

Eigen::Matrix3d rotation_zyx(double yaw_deg, double pitch_deg, double roll_deg) {
  return (Eigen::AngleAxisd(yaw_deg * kRadPerDeg, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(pitch_deg * kRadPerDeg, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(roll_deg * kRadPerDeg, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

Eigen::Matrix3d ned_from_body(const Attitude& attitude) {
  return rotation_zyx(attitude.yaw_deg, attitude.pitch_deg, attitude.roll_deg);
}

Attitude attitude_of(const Eigen::Matrix3d& ned_from_body) {
  const double sin_pitch = std::clamp(-ned_from_body(2, 0), -1.0, 1.0);
  Attitude attitude;
  attitude.pitch_deg = std::asin(sin_pitch) / kRadPerDeg;
  if (std::abs(sin_pitch) > 1 - 1e-12) {  // only the sum of yaw and roll is defined
    attitude.yaw_deg = std::atan2(-ned_from_body(0, 1), ned_from_body(1, 1)) / kRadPerDeg;
    return attitude;
  }
  attitude.yaw_deg = std::atan2(ned_from_body(1, 0), ned_from_body(0, 0)) / kRadPerDeg;
  attitude.roll_deg = std::atan2(ned_from_body(2, 1), ned_from_body(2, 2)) / kRadPerDeg;
  return attitude;
}

Eigen::Matrix3d body_from_camera(const CameraMount& mount) {
  // Straight down, top of the image to the nose: the image's x is the right wing, its y the tail.
  Eigen::Matrix3d body_from_level_camera;
  body_from_level_camera << 0, -1, 0,  //
      1, 0, 0,                         //
      0, 0, 1;
  return rotation_zyx(mount.yaw_deg, mount.pitch_deg, mount.roll_deg) * body_from_level_camera;
}

Eigen::Matrix3d enu_from_camera(const CameraMount& mount, const Attitude& attitude) {
  Eigen::Matrix3d enu_from_ned;
  enu_from_ned << 0, 1, 0,  //
      1, 0, 0,              //
      0, 0, -1;
  return enu_from_ned * ned_from_body(attitude) * body_from_camera(mount);
}

}  // namespace pilotage
