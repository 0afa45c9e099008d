#pragma once

#include <optional>
#include <string>

#include "pilotage/camera/camera.h"

namespace pilotage {

struct WorkingGsd {
  double gsd_m = 0;
  std::string reason;  ///< Why this one, as a sentence for the planner.
};

/// Side of the square with the area that a frame shows from this height in level flight: a tile is as large, whatever
/// the heading. Throws DataError when the camera sees no ground.
double footprint_side_m(const Camera& camera, double agl_m);

/// The ground sample distance at which imagery and frames are compared.
///
/// A map of 0.5 … 1 m/px matches better across dates and sensors than a finer one and is 4 … 10 times smaller
/// (docs/methods/tiling.md), so the default makes the footprint about 256 px wide (in whole centimetres per pixel)
/// within these limits; it is never finer than the imagery (`imagery_gsd_m`, the coarsest part) nor than what the
/// camera sees (`camera_gsd_m`). Throws UsageError when `wanted_gsd_m` is finer than the imagery by more than 1 %.
WorkingGsd choose_working_gsd(std::optional<double> wanted_gsd_m, double imagery_gsd_m, double camera_gsd_m,
                              double footprint_side_m);

}  // namespace pilotage
