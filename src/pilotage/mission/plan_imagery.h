#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/tile_plan.h"
#include "pilotage/raster/color_source.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/raster/raster.h"

namespace pilotage {

/// The plan's imagery as GDAL dataset strings.
std::vector<std::string> dataset_names(const TilePlan& plan);

/// The plan's imagery on the grid of one of its levels, in its own depth. Throws as open_gray_on_grid.
GraySource open_plan_imagery(const TilePlan& plan, const PlanLevel& level);

/// The same with its colours. Throws as open_colors_on_grid.
ColorSource open_plan_colors(const TilePlan& plan, const PlanLevel& level);

/// A colour picture of the corridor, at most `max_side_px` on its longer side: what a person looks at. Throws as
/// read_rgb8_on_grid.
Raster read_plan_overview(const TilePlan& plan, int max_side_px);

}  // namespace pilotage
