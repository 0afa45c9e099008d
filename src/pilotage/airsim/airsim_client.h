#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "pilotage/airsim/airsim_types.h"
#include "pilotage/airsim/rpc_client.h"

namespace pilotage {

struct AirsimClientOptions {
  double timeout_s = 60;  ///< For connecting and for each reply: Unreal may draw its first frame for long.
  RpcLimits limits;
  /// How often a frame is asked for again that came empty, which servers answer before they have drawn one.
  int image_retries = 10;
  std::string vehicle;          ///< "" is the first.
  std::function<bool()> go_on;  ///< As RpcClient takes it.
};

/// A server of the AirSim family, seen from a program. Its dialect is found, not asked for. Every function throws
/// DataError that names the server, the method and what is wrong, where the server does not do what it should
/// (rpc_client.h), and UsageError where an argument is not finite.
class AirsimClient {
 public:
  explicit AirsimClient(const HostPort& server, const AirsimClientOptions& options = {});

  AirsimDialect dialect() const { return dialect_; }
  std::int64_t server_version() const { return server_version_; }

  /// Where north, east and down are counted from.
  AirsimGeoPoint home();

  void pause(bool paused);
  /// Lets `seconds` pass in the simulation, which is paused before and after. The server replies when they have passed:
  /// a reply may take the client's timeout longer.
  void continue_for(double seconds);

  /// Puts the vehicle there, through whatever is in the way.
  void set_pose(const AirsimPose& pose);
  AirsimPose pose();
  AirsimKinematics kinematics();
  AirsimMultirotorState state();
  AirsimImu imu();

  AirsimCameraInfo camera_info(const std::string& camera);
  /// `pose`: of the camera against the vehicle's body; a camera without rotation looks ahead.
  void set_camera_pose(const std::string& camera, const AirsimPose& pose);
  void set_camera_fov(const std::string& camera, double degrees);
  /// What a camera sees, CV_8UC3 in the order blue, green, red. `compressed`: sent as PNG, which loses nothing.
  cv::Mat image(const std::string& camera, bool compressed = false);

  std::vector<std::string> scene_objects(const std::string& name_regex);
  AirsimPose object_pose(const std::string& name);

 private:
  template <class Result>
  Result ask(const std::string& method, RpcArray arguments);
  void tell(const std::string& method, RpcArray arguments);
  /// Adds the argument `external`, which one dialect does not have.
  RpcArray with_external(RpcArray arguments) const;
  std::string where(const std::string& method) const;
  AirsimDialect find_dialect();

  AirsimClientOptions options_;
  RpcClient client_;
  std::int64_t server_version_ = 0;
  AirsimDialect dialect_ = AirsimDialect::kAirsim;
};

}  // namespace pilotage
