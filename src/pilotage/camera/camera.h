#pragma once

#include <array>
#include <optional>
#include <string>

#include <Eigen/Core>

#pragma GCC visibility push(default)

namespace pilotage {

enum class DistortionModel {
  kNone,
  kBrownConrady,  ///< OpenCV's k1, k2, p1, p2, k3 (D. C. Brown, 1966).
  kFisheye,       ///< OpenCV's and Kalibr's equidistant model k1 … k4 (Kannala, Brandt, PAMI 2006).
};

/// How the camera sits on the aircraft: a rotation yaw, pitch, roll (Z-Y-X, about the body axes nose, right wing,
/// belly) away from looking straight down with the top of the image to the nose. pitch = +30 tilts the view 30°
/// forward, pitch = 90 looks ahead; roll = +30 tilts it 30° to the left; yaw = 90 turns the top of the image to the
/// right wing.
struct CameraMount {
  double yaw_deg = 0;
  double pitch_deg = 0;
  double roll_deg = 0;

  bool operator==(const CameraMount&) const = default;
};

/// A pinhole camera with distortion. Pixel centres lie at +0.5: the centre of the first pixel is (0.5, 0.5), as
/// everywhere in Pilotage; readers of OpenCV, ROS and Kalibr files (first centre at 0) add the half pixel to the
/// principal point. Camera frame: x to the right of the image, y down the image, z along the view.
struct Camera {
  int width_px = 0;
  int height_px = 0;
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  DistortionModel distortion_model = DistortionModel::kNone;
  std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3 or k1, k2, k3, k4, 0.
  CameraMount mount{};

  bool operator==(const Camera&) const = default;
};

/// What keeps `camera` from being used, as a sentence naming the value and what is allowed; "" when nothing does. Sizes
/// are 1 … 100,000 px, focal lengths finite and positive, all else finite.
std::string camera_problem(const Camera& camera);

/// Throws DataError with `name` and camera_problem() when there is one.
void check_camera(const std::string& name, const Camera& camera);

/// The same camera with its image resized to `width_px` × `height_px` (no crop).
Camera resized_camera(const Camera& camera, int width_px, int height_px);

/// The camera for a picture of another size: itself for its own size, resized_camera() for the same shape to within one
/// pixel of rounding. Throws DataError, naming `name` and both sizes, for another shape.
Camera camera_for_size(const std::string& name, const Camera& camera, int width_px, int height_px);

}  // namespace pilotage

#pragma GCC visibility pop
