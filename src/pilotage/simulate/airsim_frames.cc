#include "pilotage/simulate/airsim_frames.h"

#include <cmath>
#include <memory>
#include <mutex>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/airsim/airsim_client.h"
#include "pilotage/airsim/airsim_geometry.h"
#include "pilotage/base/angle.h"
#include "pilotage/base/error.h"
#include "pilotage/raster/elevation.h"

namespace pilotage {
namespace {

/// The one vehicle, which is moved and looked from by one thread at a time.
struct SharedVehicle {
  AirsimClient client;
  std::string camera;
  AirsimHome home;
  cv::Size size;  ///< Of its pictures.
  std::mutex mutex;

  SharedVehicle(const HostPort& server, const AirsimClientOptions& asked, std::string its_camera)
      : client(server, asked), camera(std::move(its_camera)) {}
};

void check_airsim_camera(const Camera& camera) {
  constexpr double kSlackPx = 1;
  constexpr double kSlackShape = 0.01;
  const bool centred = std::abs(camera.cx_px - camera.width_px / 2.0) <= kSlackPx &&
                       std::abs(camera.cy_px - camera.height_px / 2.0) <= kSlackPx;
  if (camera.distortion_model != DistortionModel::kNone || !centred ||
      std::abs(camera.fy_px / camera.fx_px - 1) > kSlackShape) {
    throw DataError(
        "the mission's camera has a distortion, a principal point beside the middle or pixels that are not square; "
        "AirSim's cameras have none of them");
  }
}

RenderedFrame look(SharedVehicle& vehicle, const CameraPose& pose) {
  const double altitude_m =
      std::isnan(pose.height_amsl_m) ? vehicle.home.altitude_m + pose.height_agl_m : pose.height_amsl_m;
  const Eigen::Vector3d ned_m = ned_from_place(vehicle.home, {pose.position, altitude_m});
  const std::lock_guard lock(vehicle.mutex);
  vehicle.client.set_pose({airsim_vector(ned_m), quaternion_of(ned_from_body(pose.attitude))});
  const cv::Mat seen = vehicle.client.image(vehicle.camera);
  if (seen.size() != vehicle.size) throw DataError("the simulator's pictures change their size while it flies");
  RenderedFrame frame;
  cv::cvtColor(seen, frame.gray, cv::COLOR_BGR2GRAY);
  frame.valid = frame.gray > 0;
  frame.valid_fraction = static_cast<double>(cv::countNonZero(frame.valid)) / static_cast<double>(frame.valid.total());
  return frame;
}

}  // namespace

FrameSource airsim_frames(const Mission& mission, const Camera& camera, const AirsimFrameOptions& options,
                          std::function<bool()> go_on) {
  check_options(options);
  check_airsim_camera(camera);
  const HostPort server = parse_host_port("--airsim", options.airsim, kAirsimPort);
  AirsimClientOptions asked;
  asked.timeout_s = options.airsim_timeout_s;
  asked.vehicle = options.airsim_vehicle;
  asked.go_on = std::move(go_on);
  const auto vehicle = std::make_shared<SharedVehicle>(server, asked, options.airsim_camera);
  const AirsimGeoPoint home = vehicle->client.home();
  vehicle->home = {{home.longitude, home.latitude}, static_cast<double>(home.altitude)};
  vehicle->client.set_camera_pose(vehicle->camera, {{}, quaternion_of(airsim_camera_rotation(camera.mount))});
  vehicle->client.set_camera_fov(vehicle->camera, 2 * std::atan(camera.width_px / (2 * camera.fx_px)) / kRadPerDeg);
  vehicle->size = vehicle->client.image(vehicle->camera).size();

  FrameSource frames;
  frames.camera = camera_for_size(server.text() + ": camera \"" + vehicle->camera + "\"", camera, vehicle->size.width,
                                  vehicle->size.height);
  frames.open = [vehicle, elevation = mission.ground.elevation] {
    const std::shared_ptr<Elevation> heights = elevation.empty() ? nullptr : std::make_shared<Elevation>(elevation);
    return FrameTaker{[vehicle](const CameraPose& pose) { return look(*vehicle, pose); },
                      [heights](GeodeticPoint point) { return heights ? heights->amsl_m(point) : kNaN; }};
  };
  frames.notes = {"frames are those of the simulator at " + server.text() +
                  "; where its ground is not that of the map, no fix can come"};
  frames.not_simulated = {"frames that are answered late: a fix comes at once",
                          "what the simulator leaves out of light, weather and the sensor"};
  return frames;
}

}  // namespace pilotage
