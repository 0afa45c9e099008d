#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "pilotage/airsim/airsim_types.h"

namespace pilotage {

/// What a vehicle is asked to do.
struct AirsimMotion {
  std::vector<Eigen::Vector3d> path;  ///< Places to go to in order, north, east, down; empty: `velocity_mps` instead.
  double speed_mps = 0;
  Eigen::Vector3d velocity_mps{0, 0, 0};
  double left_s = 0;  ///< Then a path is given up, and a velocity has been flown.
  bool nose_ahead = false;
  AirsimYawMode yaw;
  bool lands = false;                   ///< Stands on the ground afterwards.
  std::optional<double> hold_down_m{};  ///< With a velocity: instead of its vertical part, to this height, and there.
  bool in_body_frame = false;           ///< The velocity is ahead, right, down of the vehicle as it turns.
};

/// A multirotor without forces: it has the velocity that it is asked for at once, stands level while it moves, and
/// turns by 90° a second. North, east, down in metres.
class AirsimVehicle {
 public:
  Eigen::Vector3d position_m{0, 0, 0};
  AirsimQuaternion orientation;
  Eigen::Vector3d velocity_mps{0, 0, 0};
  double yaw_rate_radps = 0;
  bool flies = false;

  /// The pose that it is put to; it stands still there. Numbers that are NaN leave theirs as they are.
  void put(const AirsimPose& pose);

  AirsimPose pose() const;
  AirsimKinematics kinematics() const;

  void begin(const AirsimMotion& motion);
  bool moves() const { return motion_.has_value(); }
  void stop();

  /// Lets time pass. When the motion ends in it: whether it did what was asked.
  std::optional<bool> advance(double seconds);

 private:
  std::optional<bool> step(double seconds);
  bool follow_path(double seconds);
  void fly_velocity(double seconds);
  void turn(double seconds);

  std::optional<AirsimMotion> motion_;
  std::size_t next_ = 0;  ///< Of the path.
};

}  // namespace pilotage
