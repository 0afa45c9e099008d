#include "pilotage/camera/camera_json.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/camera/camera_text.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kMaxSize_px = 100000;

/// Whole numbers are written without a point.
Json number(double value) {
  if (value == std::floor(value) && std::abs(value) < 1e15) return static_cast<std::int64_t>(value);
  return value;
}

}  // namespace

Json camera_to_json(const Camera& camera) {
  return {{"width_px", camera.width_px},
          {"height_px", camera.height_px},
          {"fx_px", number(camera.fx_px)},
          {"fy_px", number(camera.fy_px)},
          {"cx_px", number(camera.cx_px)},
          {"cy_px", number(camera.cy_px)},
          {"distortion_model", distortion_model_name(camera.distortion_model)},
          {"distortion", camera.distortion},
          {"mount",
           {{"yaw_deg", number(camera.mount.yaw_deg)},
            {"pitch_deg", number(camera.mount.pitch_deg)},
            {"roll_deg", number(camera.mount.roll_deg)}}}};
}

Camera camera_from_json(const std::string& name, const Json& json) {
  JsonObject object(json, name);
  Camera camera;
  camera.width_px = object.small_integer("width_px", 1, kMaxSize_px);
  camera.height_px = object.small_integer("height_px", 1, kMaxSize_px);
  camera.fx_px = object.number("fx_px");
  camera.fy_px = object.number("fy_px");
  camera.cx_px = object.number("cx_px");
  camera.cy_px = object.number("cy_px");
  const auto model = distortion_model_named(object.text("distortion_model"));
  if (!model) object.fail("distortion_model", "one of: none, brown_conrady, fisheye");
  camera.distortion_model = *model;
  std::ranges::copy(object.numbers("distortion", camera.distortion.size()), camera.distortion.begin());
  JsonObject mount = object.object("mount");
  camera.mount = {mount.number("yaw_deg"), mount.number("pitch_deg"), mount.number("roll_deg")};
  mount.finish();
  object.finish();
  check_camera(name, camera);
  return camera;
}

}  // namespace pilotage
