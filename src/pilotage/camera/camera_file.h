#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "pilotage/camera/camera.h"

namespace pilotage {

/// Reads a camera calibration, whatever its name ends with:
///   ROS camera_info, as camera_calibration_parsers writes it (image_width, image_height, camera_matrix,
///     distortion_model plumb_bob or equidistant, distortion_coefficients) and as a message of ROS 1 (K, D as lists) or
///     ROS 2 (k, d), of which binning_x, binning_y and roi count: the camera is that of the picture that is sent;
///   OpenCV FileStorage, YAML or XML: camera_matrix (or cameraMatrix, K), distortion_coefficients (or distCoeffs, D),
///     image_width, image_height, fisheye_model;
///   Kalibr camchain with one camera: camera_model (pinhole), intrinsics, distortion_model (radtan, equidistant, none),
///     distortion_coeffs, resolution.
///   COLMAP's cameras.txt and Agisoft's calibration (photogrammetry_cameras.h).
/// The first three put the centre of the first pixel at (0, 0); the result has it at (0.5, 0.5). Coefficients beyond k3
/// (rational, thin-prism, tilted models) are accepted only when they are zero. Four coefficients without a model are
/// refused unless they are zero: OpenCV's fisheye writes four, and so does Brown–Conrady without k3. The mount is left
/// at its default. Throws DataError naming the file and the key.
Camera read_camera_file(const std::filesystem::path& path);

/// The same from text; `name` stands in for the file in messages.
Camera parse_camera_file(const std::string& name, std::string_view text);

}  // namespace pilotage
