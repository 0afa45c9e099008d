#include "pilotage/camera/camera.h"

#include <cmath>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"

namespace pilotage {
namespace {

constexpr int kMaxSizePx = 100000;

std::string outside(const std::string& what, double value, const std::string& allowed) {
  return what + " = " + format_number(value) + " is not " + allowed;
}

std::string size_text(int width_px, int height_px) {
  return std::to_string(width_px) + " x " + std::to_string(height_px) + " px";
}

}  // namespace

std::string camera_problem(const Camera& camera) {
  if (camera.width_px < 1 || camera.width_px > kMaxSizePx) {
    return outside("width_px", camera.width_px, "in [1, 100000]");
  }
  if (camera.height_px < 1 || camera.height_px > kMaxSizePx) {
    return outside("height_px", camera.height_px, "in [1, 100000]");
  }
  // A focal length this far from the image's size is a wrong unit, and would overflow further on.
  const auto bad_focal = [](double focal_px) { return !(focal_px >= 1e-3 && focal_px <= 1e9); };
  if (bad_focal(camera.fx_px)) return outside("fx_px", camera.fx_px, "in [0.001, 1e9]");
  if (bad_focal(camera.fy_px)) return outside("fy_px", camera.fy_px, "in [0.001, 1e9]");
  if (!(std::abs(camera.cx_px) <= 1e9)) return outside("cx_px", camera.cx_px, "in [-1e9, 1e9]");
  if (!(std::abs(camera.cy_px) <= 1e9)) return outside("cy_px", camera.cy_px, "in [-1e9, 1e9]");
  for (const double coefficient : camera.distortion) {
    if (!(std::abs(coefficient) <= 1e9)) return outside("a distortion coefficient", coefficient, "in [-1e9, 1e9]");
  }
  for (const double angle_deg : {camera.mount.yaw_deg, camera.mount.pitch_deg, camera.mount.roll_deg}) {
    if (!(std::abs(angle_deg) <= 360)) return outside("a mount angle", angle_deg, "in [-360, 360]");
  }
  return "";
}

void check_camera(const std::string& name, const Camera& camera) {
  const std::string problem = camera_problem(camera);
  if (!problem.empty()) throw DataError(name + ": " + problem);
}

Camera resized_camera(const Camera& camera, int width_px, int height_px) {
  const double x_factor = static_cast<double>(width_px) / camera.width_px;
  const double y_factor = static_cast<double>(height_px) / camera.height_px;
  Camera resized = camera;
  resized.width_px = width_px;
  resized.height_px = height_px;
  resized.fx_px *= x_factor;
  resized.cx_px *= x_factor;
  resized.fy_px *= y_factor;
  resized.cy_px *= y_factor;
  return resized;
}

Camera camera_for_size(const std::string& name, const Camera& camera, int width_px, int height_px) {
  if (camera.width_px == width_px && camera.height_px == height_px) return camera;
  const double height_to_width = static_cast<double>(camera.height_px) / camera.width_px;
  const bool same_shape =
      std::abs(height_px - width_px * height_to_width) <= 1 || std::abs(width_px - height_px / height_to_width) <= 1;
  if (same_shape) return resized_camera(camera, width_px, height_px);
  throw DataError(name + ": has " + size_text(width_px, height_px) + ", the camera " +
                  size_text(camera.width_px, camera.height_px) +
                  ": another shape, so it is not this camera's frame or only a part of one");
}

}  // namespace pilotage
