#pragma once

#include "country/objects.h"
#include "country/surface.h"

namespace pilotage::scene_detail {

/// Puts roofs, vehicles and trees over the ground's surface, and returns the sunlight that their shadows leave at the
/// point (1 = none in the way).
float overlay_objects(const ObjectIndex& objects, const GroundPoint& at, Surface& surface);

}  // namespace pilotage::scene_detail
