#pragma once

#include <string>

#pragma GCC visibility push(default)

namespace pilotage {

/// The camera that a survey plan names (QGroundControl's CameraCalc). Zero where the plan does not tell.
struct RouteCamera {
  std::string name;
  double sensor_width_mm = 0;
  double sensor_height_mm = 0;
  double focal_length_mm = 0;
  int image_width_px = 0;
  int image_height_px = 0;
};

}  // namespace pilotage

#pragma GCC visibility pop
