#include "pilotage/camera/camera_options.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/camera/camera_file.h"
#include "pilotage/camera/camera_products.h"

namespace pilotage {
namespace {

constexpr double kMaxPixelAspectError = 0.05;

/// A set of options that belong together: which of them are given, which are not.
struct OptionSet {
  std::vector<std::string> given;
  std::vector<std::string> missing;

  void add(bool is_given, const char* flag) { (is_given ? given : missing).emplace_back(flag); }
};

OptionSet sensor_options(const CameraOptions& options) {
  OptionSet set;
  set.add(options.sensor_width_mm.has_value(), "--camera-sensor-width-mm");
  set.add(options.sensor_height_mm.has_value(), "--camera-sensor-height-mm");
  set.add(options.focal_length_mm.has_value(), "--camera-focal-length-mm");
  return set;
}

OptionSet size_options(const CameraOptions& options) {
  OptionSet set;
  set.add(options.width_px.has_value(), "--camera-width-px");
  set.add(options.height_px.has_value(), "--camera-height-px");
  return set;
}

void refuse_together(const std::vector<std::string>& one, const std::vector<std::string>& other) {
  if (one.empty() || other.empty()) return;
  throw UsageError(join(one, ", ") + " and " + join(other, ", ") + " exclude each other: give the camera in one way");
}

void require_all(const std::string& because_of, std::vector<std::string> missing, const OptionSet& more) {
  missing.insert(missing.end(), more.missing.begin(), more.missing.end());
  if (!missing.empty()) throw UsageError(because_of + " needs " + join(missing, ", ") + " too");
}

Camera ideal_camera(int width_px, int height_px, double fx_px, double fy_px) {
  Camera camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.fx_px = fx_px;
  camera.fy_px = fy_px;
  camera.cx_px = width_px / 2.0;
  camera.cy_px = height_px / 2.0;
  return camera;
}

/// A sentence when sensor and image do not have the same shape, else "".
std::string shape_problem(double sensor_width_mm, double sensor_height_mm, int width_px, int height_px) {
  const double aspect = (sensor_width_mm / width_px) / (sensor_height_mm / height_px);
  if (std::abs(std::log(aspect)) <= std::log1p(kMaxPixelAspectError)) return "";
  return "a sensor of " + format_number(sensor_width_mm) + " mm x " + format_number(sensor_height_mm) +
         " mm does not have the shape of an image of " + std::to_string(width_px) + " px x " +
         std::to_string(height_px) + " px: pixels would be " + format_fixed(aspect, 3) +
         " times as wide as high. Give the part of the sensor that the image shows";
}

Camera sensor_camera(double sensor_width_mm, double sensor_height_mm, double focal_length_mm, int width_px,
                     int height_px) {
  return ideal_camera(width_px, height_px, focal_length_mm / sensor_width_mm * width_px,
                      focal_length_mm / sensor_height_mm * height_px);
}

Camera camera_of_route(const RouteCamera& route) {
  const std::string name = "the route's camera \"" + route.name + "\"";
  const auto expect_positive = [&](const char* what, double value) {
    if (value > 0 && std::isfinite(value)) return;
    throw DataError(name + ": " + what + " = " + format_number(value) +
                    " is not above 0; give the camera by --camera or its size and field of view");
  };
  expect_positive("sensor_width_mm", route.sensor_width_mm);
  expect_positive("sensor_height_mm", route.sensor_height_mm);
  expect_positive("focal_length_mm", route.focal_length_mm);
  expect_positive("image_width_px", route.image_width_px);
  expect_positive("image_height_px", route.image_height_px);
  const std::string problem =
      shape_problem(route.sensor_width_mm, route.sensor_height_mm, route.image_width_px, route.image_height_px);
  if (!problem.empty()) throw DataError(name + ": " + problem);
  const Camera camera = sensor_camera(route.sensor_width_mm, route.sensor_height_mm, route.focal_length_mm,
                                      route.image_width_px, route.image_height_px);
  check_camera(name, camera);
  return camera;
}

Camera camera_of_options(const CameraOptions& options, const std::optional<RouteCamera>& route_camera) {
  const OptionSet sensor = sensor_options(options);
  const OptionSet size = size_options(options);
  std::vector<std::string> file;
  if (!options.file.empty()) file.emplace_back("--camera");
  std::vector<std::string> field_of_view;
  if (options.hfov_deg) field_of_view.emplace_back("--camera-hfov-deg");
  std::vector<std::string> name;
  if (!options.name.empty()) name.emplace_back("--camera-name");
  refuse_together(file, name);
  refuse_together(name, field_of_view);
  refuse_together(name, sensor.given);
  refuse_together(name, size.given);
  refuse_together(file, field_of_view);
  refuse_together(file, sensor.given);
  refuse_together(file, size.given);
  refuse_together(field_of_view, sensor.given);

  if (!file.empty()) return read_camera_file(options.file);
  if (!name.empty()) return camera_of(camera_product(options.name));
  if (options.hfov_deg) {
    require_all("--camera-hfov-deg", {}, size);
    const double focal_px = *options.width_px / 2.0 / std::tan(*options.hfov_deg / 2 * std::numbers::pi / 180);
    return ideal_camera(*options.width_px, *options.height_px, focal_px, focal_px);
  }
  if (!sensor.given.empty()) {
    require_all(sensor.given.front(), sensor.missing, size);
    const std::string problem =
        shape_problem(*options.sensor_width_mm, *options.sensor_height_mm, *options.width_px, *options.height_px);
    if (!problem.empty()) throw UsageError(problem);
    return sensor_camera(*options.sensor_width_mm, *options.sensor_height_mm, *options.focal_length_mm,
                         *options.width_px, *options.height_px);
  }
  if (!size.given.empty()) {
    require_all(size.given.front(), size.missing, {});
    throw UsageError(join(size.given, ", ") +
                     " needs --camera-hfov-deg too, or --camera-sensor-width-mm, --camera-sensor-height-mm and "
                     "--camera-focal-length-mm");
  }
  if (route_camera) return camera_of_route(*route_camera);
  throw UsageError(
      "no camera: give --camera FILE, or --camera-name, or --camera-hfov-deg, --camera-width-px and "
      "--camera-height-px, or "
      "--camera-sensor-width-mm, --camera-sensor-height-mm, --camera-focal-length-mm, --camera-width-px and "
      "--camera-height-px");
}

}  // namespace

bool names_camera(const CameraOptions& options) {
  return !options.file.empty() || !options.name.empty() || options.hfov_deg || options.width_px || options.height_px ||
         options.sensor_width_mm || options.sensor_height_mm || options.focal_length_mm;
}

Camera make_camera(const CameraOptions& options, const std::optional<RouteCamera>& route_camera) {
  check_options(options);
  Camera camera = camera_of_options(options, route_camera);
  camera.mount = {options.mount_yaw_deg, options.mount_pitch_deg, options.mount_roll_deg};
  const std::string problem = camera_problem(camera);
  if (!problem.empty()) throw UsageError("camera: " + problem);
  return camera;
}

}  // namespace pilotage
