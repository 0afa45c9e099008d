#pragma once

#include "pilotage/base/progress.h"
#include "pilotage/mission/mission.h"
#include "pilotage/tile/tile_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Cuts the corridor along the route into tiles the size of the camera's footprint.
///
/// The mission grid: its CRS has the least scale distortion over the corridor unless options.crs names one; its pixels
/// are as choose_working_gsd says; its origin is a whole multiple of the pixel. A tile is the square with the area of
/// the footprint at the height of its level, whatever the heading. Heights of the route that differ by more than a
/// factor of 2 are served by several levels, each for one band of heights. The corridor is corridor_half_width_m wide
/// on each side: by default max_error_m, since the aircraft may be off the route by its position error and must then
/// find its frame in the map. The tile nearest to a point of the route is always cut, even when its centre lies outside
/// a corridor narrower than the tiles' stride.
///
/// Where GNSS is denied stands in the plan as read_denial() (denied_stretches.h) finds it.
///
/// Throws UsageError for options that are missing or outside their range, DataError when a file cannot be used, or when
/// a part of the route lies outside the imagery (naming which part and how far) or a tile is larger than all of it,
/// unless options.allow_uncovered.
Mission plan_tiles(const TileOptions& options, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
