#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pilotage/camera/camera.h"

namespace pilotage {

/// The models as files name them: none, brown_conrady, fisheye; nothing for a name that is none of them.
std::string distortion_model_name(DistortionModel model);
std::optional<DistortionModel> distortion_model_named(std::string_view name);

/// Key and value, in the order in which they are stored.
using CameraText = std::vector<std::pair<std::string, std::string>>;

/// The camera as pairs of text, numbers in the shortest form that reads back exactly: width_px, height_px, fx_px,
/// fy_px, cx_px, cy_px, distortion_model (none, brown_conrady, fisheye), distortion (five numbers, blank separated),
/// mount_yaw_deg, mount_pitch_deg, mount_roll_deg. This is the form the map database keeps, readable without JSON.
CameraText camera_to_text(const Camera& camera);

/// The inverse. `name` stands for the source in messages. Throws DataError when a key is missing, unknown or stands
/// twice, when a value cannot be read, or when the camera has a problem (camera_problem()).
Camera camera_from_text(const std::string& name, const CameraText& text);

}  // namespace pilotage
