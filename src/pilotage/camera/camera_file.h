#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pilotage/camera/camera.h"

namespace pilotage {

/// Reads a camera calibration in one of three YAML dialects, told apart by their keys:
///   ROS camera_info (camera_calibration_parsers):  image_width, image_height, camera_matrix, distortion_model
///     (plumb_bob, equidistant), distortion_coefficients;
///   OpenCV FileStorage (%YAML:1.0, !!opencv-matrix): camera_matrix (or cameraMatrix, K), distortion_coefficients
///     (or distCoeffs, D), image_width, image_height, fisheye_model;
///   Kalibr camchain with one camera: camera_model (pinhole), intrinsics, distortion_model (radtan, equidistant, none),
///     distortion_coeffs, resolution.
/// All three put the centre of the first pixel at (0, 0); the result has it at (0.5, 0.5). Coefficients beyond k3
/// (rational, thin-prism, tilted models) are accepted only when they are zero. The mount is left at its default. Throws
/// DataError naming the file and the key.
Camera read_camera_file(const std::filesystem::path& path);

/// The same from text; `name` stands in for the file in messages.
Camera parse_camera_yaml(const std::string& name, std::string_view text);

}  // namespace pilotage
