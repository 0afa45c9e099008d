#include "pilotage/simulate/airsim_scene.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace pilotage {
namespace {

constexpr double kLeastHeight_m = 0.1;

}  // namespace

AirsimHome airsim_home(const Mission& mission, const WorldCamera& camera) {
  const GeodeticPoint start = mission.flight.samples.front().point;
  const double ground_m = camera.ground_amsl_m(start);
  return {start, std::isnan(ground_m) ? 0 : ground_m};
}

AirsimScene airsim_scene(const Mission& mission, const RenderedWorld& world, const Camera& camera) {
  // Of the camera that was asked for last: its field of view is rarely changed.
  auto taker = std::make_shared<WorldCamera>(world, camera);
  AirsimScene scene;
  scene.home = airsim_home(mission, *taker);
  scene.camera = camera;
  scene.frame = [taker, &world, home = scene.home](const AirsimView& view) mutable {
    if (taker->camera() != view.camera) taker = std::make_shared<WorldCamera>(world, view.camera);
    CameraPose pose;
    pose.position = view.place.point;
    pose.attitude = view.attitude;
    const bool flat = world.elevation.empty();
    const double ground_m = flat ? home.altitude_m : taker->ground_amsl_m(view.place.point);
    // Where the ground is not known nothing is seen, from whatever height.
    pose.height_agl_m = std::max(std::isnan(ground_m) ? 0 : view.place.altitude_m - ground_m, kLeastHeight_m);
    pose.height_amsl_m = flat ? kNaN : view.place.altitude_m;
    return taker->frame_at(pose).gray;
  };
  return scene;
}

}  // namespace pilotage
