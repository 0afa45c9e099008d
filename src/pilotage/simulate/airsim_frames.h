#pragma once

#include <functional>
#include <string>

#include "pilotage/airsim/airsim_types.h"
#include "pilotage/base/options.h"
#include "pilotage/simulate/rendered_fixes.h"

namespace pilotage {

/// Which simulator frames come from, and how it is asked.
struct AirsimFrameOptions {
  std::string airsim;
  std::string airsim_camera = "bottom_center";
  std::string airsim_vehicle;
  double airsim_timeout_s = 60;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.field("airsim", self.airsim, "With --fixes airsim: HOST:PORT of the simulator.");
    fields.field("airsim_camera", self.airsim_camera,
                 "Its camera that is turned and zoomed as the mission's, and takes the frames.");
    fields.field("airsim_vehicle", self.airsim_vehicle, "Its vehicle that carries the camera; default the first.");
    fields.field("airsim_timeout_s", self.airsim_timeout_s, "How long a reply of the simulator may take.",
                 Range{0.1, 3600});
  }
};

/// Frames of a server of the AirSim family (airsim/airsim_client.h), whose camera takes the mount and the field of view
/// of `camera`; FrameSource::camera has its pixels. North, east and down are of the server's home, heights above sea
/// level of its altitude; where the mission knows no elevation, the home's height is the ground. What is black shows no
/// ground. One connection serves all threads. Throws DataError when `camera` is none that AirSim has (distorted, pixels
/// that are not square, principal point beside the middle), for a server whose pictures are of another shape, and as
/// AirsimClient; UsageError as parse_host_port. `go_on` is asked while the server is waited for (RpcClient), from any
/// thread.
FrameSource airsim_frames(const Mission& mission, const Camera& camera, const AirsimFrameOptions& options,
                          std::function<bool()> go_on = {});

}  // namespace pilotage
