#pragma once

#include <Eigen/Core>

#include "pilotage/camera/camera.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Attitude of the aircraft's body (x nose, y right wing, z belly) against north, east, down: first yaw about down,
/// then pitch about the new y, then roll about the new x (Z-Y-X). yaw = 0 points the nose north, 90 east; pitch > 0
/// raises the nose; roll > 0 lowers the right wing.
struct Attitude {
  double yaw_deg = 0;
  double pitch_deg = 0;
  double roll_deg = 0;
};

/// Rotation by yaw, pitch, roll in the order Z-Y-X: turns vectors of the rotated frame into the outer one.
Eigen::Matrix3d rotation_zyx(double yaw_deg, double pitch_deg, double roll_deg);

/// Turns vectors of the body frame into north, east, down.
Eigen::Matrix3d ned_from_body(const Attitude& attitude);

/// The inverse of ned_from_body; straight up or down, where only the sum of yaw and roll is defined, roll is 0.
Attitude attitude_of(const Eigen::Matrix3d& ned_from_body);

/// Turns vectors of the camera frame (x right, y down the image, z along the view) into the body frame.
Eigen::Matrix3d body_from_camera(const CameraMount& mount);

/// Turns vectors of the camera frame into east, north, up.
Eigen::Matrix3d enu_from_camera(const CameraMount& mount, const Attitude& attitude);

}  // namespace pilotage

#pragma GCC visibility pop
