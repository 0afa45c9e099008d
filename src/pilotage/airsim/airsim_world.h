#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/airsim/airsim_simulation.h"

namespace pilotage {

/// An image that is to be drawn: all but its pixels, and what the camera looked at.
struct AirsimShot {
  AirsimImage image;
  AirsimView view;
};

/// The state of a simulation: what its methods read and change.
class AirsimWorld {
 public:
  explicit AirsimWorld(AirsimScene scene);

  const AirsimScene scene;
  AirsimVehicle vehicle;
  bool paused = false;
  bool controlled = false;  ///< enableApiControl.
  bool armed = false;

  /// As after the start, but for the time.
  void reset();

  void advance(double seconds);
  std::uint64_t time_ns() const { return time_ns_; }

  /// Begins a motion, which `ticket` is answered for when it ends. What went on before is answered with false.
  void begin(const RpcTicket& ticket, const AirsimMotion& motion);
  void cancel();
  std::vector<RpcTicketAnswer> take_finished();

  // Cameras by the names "bottom_center" or "3", and so on. They throw DataError where there is none.
  AirsimCameraInfo camera_info(const std::string& name) const;
  void set_camera_pose(const std::string& name, const AirsimPose& pose);
  void set_camera_fov(const std::string& name, double degrees);
  /// An image is asked for, and drawn later, as the world was when it was asked for.
  AirsimShot shot(const AirsimImageRequest& request) const;
  AirsimImage develop(const AirsimShot& shot) const;

  // What the sensors would say without errors.
  AirsimPlace place() const { return place_from_ned(scene.home, vehicle.position_m); }
  AirsimGeoPoint geo_point() const;
  AirsimImu imu() const;
  AirsimBarometer barometer() const;
  AirsimGps gps() const;
  AirsimMultirotorState state() const;

  std::vector<std::string> object_names(const std::string& pattern) const;
  AirsimPose object_pose(const std::string& name) const;

 private:
  struct FittedCamera {
    Eigen::Vector3d position_m{0, 0, 0};  ///< On the body.
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Camera camera;  ///< Without mount.
  };

  const FittedCamera& camera(const std::string& name) const;
  AirsimPose camera_pose(const FittedCamera& camera) const;
  void fit_cameras();
  void finish(bool done);

  std::uint64_t time_ns_ = 0;
  std::map<std::string, FittedCamera> cameras_;
  std::optional<RpcTicket> open_;
  std::vector<RpcTicketAnswer> finished_;
};

}  // namespace pilotage
