#pragma once

#include <Eigen/Core>

#include "pilotage/airsim/airsim_types.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/geo/geodetic_point.h"

namespace pilotage {

/// Where a vehicle of the simulator starts: north, east and down are counted from there.
struct AirsimHome {
  GeodeticPoint point;
  double altitude_m = 0;
};

/// A place, with its height on the same scale as the home's.
struct AirsimPlace {
  GeodeticPoint point;
  double altitude_m = 0;
};

/// North and east are true metres on the ellipsoid's tangent plane at the home; down is the height below the home, so
/// that the world is flat, as that of Unreal (docs/methods/airsim.md). Throws UsageError when the home is not finite.
Eigen::Vector3d ned_from_place(const AirsimHome& home, const AirsimPlace& place);
AirsimPlace place_from_ned(const AirsimHome& home, const Eigen::Vector3d& ned_m);

/// Turns vectors of the body into north, east, down. The quaternion need not be of length 1; of one without a length,
/// or not finite, the rotation is none.
Eigen::Matrix3d rotation_of(const AirsimQuaternion& quaternion);
AirsimQuaternion quaternion_of(const Eigen::Matrix3d& rotation);

AirsimVector airsim_vector(const Eigen::Vector3d& vector);
Eigen::Vector3d vector_of(const AirsimVector& vector);

/// The simulator's rotation of a camera that is mounted so on the body: its cameras look along x, with y to the right
/// of the image and z down it.
Eigen::Matrix3d airsim_camera_rotation(const CameraMount& mount);

/// The attitude of a body without mount (camera/camera.h) whose camera stands like the simulator's camera with this
/// rotation against north, east, down.
Attitude attitude_of_camera(const Eigen::Matrix3d& ned_from_airsim_camera);

}  // namespace pilotage
