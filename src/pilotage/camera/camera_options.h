#pragma once

#include <optional>
#include <string>

#include "pilotage/base/options.h"
#include "pilotage/camera/camera.h"
#include "pilotage/camera/route_camera.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// How the aircraft sees the ground. One complete way to say it must be given:
///   file                                                      a calibration file (camera_file.h)
///   hfov_deg, width_px, height_px                             an ideal lens
///   sensor_width_mm, sensor_height_mm, focal_length_mm, width_px, height_px
///   name                                                      a product of camera_products.h
/// or none of them when the route names a camera.
struct CameraOptions {
  std::string file;
  std::string name;
  std::optional<double> hfov_deg;
  std::optional<int> width_px;
  std::optional<int> height_px;
  std::optional<double> sensor_width_mm;
  std::optional<double> sensor_height_mm;
  std::optional<double> focal_length_mm;
  double mount_yaw_deg = 0;
  double mount_pitch_deg = 0;
  double mount_roll_deg = 0;

  template <class Self, class Fields>
  static void describe(Self& self, Fields& fields) {
    fields.path("file", self.file,
                "Camera calibration: ROS camera_info or its message, OpenCV (YAML, XML), Kalibr, COLMAP, Agisoft.");
    fields.field(
        "name", self.name,
        "A camera by the name it is sold under, as \"DJI Mavic 3E\": the whole photo, an ideal lens; list names "
        "all.");
    fields.field("hfov_deg", self.hfov_deg,
                 "Horizontal field of view; what is below would be radians: such a lens is given by its focal length.",
                 Range{3.15, 179});
    fields.field("width_px", self.width_px, "Width of the image.", Range{1, 100000});
    fields.field("height_px", self.height_px, "Height of the image.", Range{1, 100000});
    fields.field("sensor_width_mm", self.sensor_width_mm, "Width of the part of the sensor that the image shows.",
                 Range{0.1, 1000});
    fields.field("sensor_height_mm", self.sensor_height_mm, "Height of the part of the sensor that the image shows.",
                 Range{0.1, 1000});
    fields.field("focal_length_mm", self.focal_length_mm, "True focal length (not the 35 mm equivalent).",
                 Range{0.1, 100000});
    fields.field("mount_yaw_deg", self.mount_yaw_deg, "Turns the top of the image from the nose to the right wing.",
                 Range{-360, 360});
    fields.field("mount_pitch_deg", self.mount_pitch_deg, "Tilts the view from straight down to ahead.",
                 Range{-180, 180});
    fields.field("mount_roll_deg", self.mount_roll_deg, "Tilts the view from straight down to the left.",
                 Range{-180, 180});
  }
};

/// Whether `options` begin to describe a camera; a mount alone does not.
bool names_camera(const CameraOptions& options);

/// The camera that `options` describe; when they give no way at all, the one of the route, with the mount of the
/// options. Options win over the route's camera. Throws UsageError when more than one way is begun, when one is
/// incomplete (naming what is missing), when pixels would not be square within 5 %, or when there is nothing to go by;
/// DataError when the file or the route's camera cannot be used.
Camera make_camera(const CameraOptions& options, const std::optional<RouteCamera>& route_camera = std::nullopt);

}  // namespace pilotage

#pragma GCC visibility pop
