#pragma once

#include "pilotage/camera/camera.h"

namespace pilotage::testing {

/// A camera without distortion whose principal point is the middle of the frame.
inline Camera pinhole_camera(int width_px, int height_px, double focal_px) {
  return {width_px, height_px, focal_px, focal_px, width_px / 2.0, height_px / 2.0};
}

}  // namespace pilotage::testing
