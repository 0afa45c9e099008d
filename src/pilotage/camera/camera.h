#pragma once

#include <array>
#include <optional>
#include <string>

#include <Eigen/Core>

namespace pilotage {

enum class DistortionModel {
  kNone,
  kBrownConrady,  ///< OpenCV's k1, k2, p1, p2, k3 (D. C. Brown, 1966).
  kFisheye,       ///< OpenCV's and Kalibr's equidistant model k1 … k4 (Kannala, Brandt, PAMI 2006).
};

/// A pinhole camera with distortion. Pixel centres lie at +0.5: the centre of the first pixel is (0.5, 0.5), as everywhere in
/// Pilotage; readers of OpenCV, ROS and Kalibr files (first centre at 0) add the half pixel to the principal point.
/// Camera frame: x to the right of the image, y down the image, z along the view.
struct Camera {
  int width_px = 0;
  int height_px = 0;
  double fx_px = 0;
  double fy_px = 0;
  double cx_px = 0;
  double cy_px = 0;
  DistortionModel distortion_model = DistortionModel::kNone;
  std::array<double, 5> distortion{};  ///< k1, k2, p1, p2, k3 or k1, k2, k3, k4, 0.
};

}  // namespace pilotage
