#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/airsim/airsim_geometry.h"
#include "pilotage/airsim/airsim_types.h"
#include "pilotage/airsim/airsim_vehicle.h"
#include "pilotage/airsim/rpc_server.h"
#include "pilotage/camera/camera.h"

namespace pilotage {

/// A camera of the simulator in the air. Its own mount is none: `attitude` is that of a body that carries it so.
struct AirsimView {
  Camera camera;
  AirsimPlace place;
  Attitude attitude;
};

/// What a simulation shows.
struct AirsimScene {
  AirsimHome home;
  /// All cameras have its pixels; "bottom_center" has its mount, too.
  Camera camera;
  std::map<std::string, AirsimPose> objects;
  /// CV_8UC1 or CV_8UC3 (blue, green, red) of the camera's size. May throw DataError and UsageError, which callers get
  /// as errors.
  std::function<cv::Mat(const AirsimView& view)> frame;
};

/// The names that the vehicle of a simulation answers to: this and "".
inline constexpr const char* kAirsimVehicle = "SimpleFlight";

/// A server of the AirSim family without Unreal: one multirotor without forces over a scene. What it answers, and what
/// it leaves out: docs/methods/airsim.md. Time goes on with step(), unless it is paused, and with simContinueForTime,
/// which lets it pass at once.
class AirsimSimulation {
 public:
  /// Throws DataError when the camera has a problem, or an image more than 64 MiB, which no answer holds.
  AirsimSimulation(AirsimDialect dialect, AirsimScene scene);
  ~AirsimSimulation();
  AirsimSimulation(const AirsimSimulation&) = delete;
  AirsimSimulation& operator=(const AirsimSimulation&) = delete;

  /// For serve_rpc; holds a reference to this.
  RpcService service();

 private:
  class Methods;
  std::unique_ptr<Methods> methods_;
};

}  // namespace pilotage
