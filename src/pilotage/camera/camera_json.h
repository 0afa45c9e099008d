#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/camera/camera.h"

namespace pilotage {

/// The camera as a JSON object: width_px, height_px, fx_px, fy_px, cx_px, cy_px, distortion_model, distortion (array of
/// five), mount {yaw_deg, pitch_deg, roll_deg}. Pixel centres at +0.5.
nlohmann::ordered_json camera_to_json(const Camera& camera);

/// The inverse; strict: throws DataError naming `name` and the key when one is missing, unknown or of another type, or
/// when the camera has a problem (camera_problem()).
Camera camera_from_json(const std::string& name, const nlohmann::ordered_json& json);

}  // namespace pilotage
