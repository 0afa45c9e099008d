#pragma once

#include "pilotage/camera/camera.h"

namespace pilotage {

/// How differently two cameras look from the same aircraft: the largest angle between the rays of the same place of
/// their images (centre, corners and middles of the sides), mounts included, degrees. The sizes of the images do not
/// matter; infinite when their shapes differ (camera_for_size), or when a lens does not see such a place. Throws
/// DataError when a camera has a problem.
double camera_difference_deg(const Camera& a, const Camera& b);

}  // namespace pilotage
