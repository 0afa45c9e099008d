#pragma once

#include <string>
#include <vector>

#include "pilotage/ground/ground.h"
#include "pilotage/raster/color_source.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/raster/raster.h"

namespace pilotage {

/// The imagery as GDAL dataset strings.
std::vector<std::string> dataset_names(const Imagery& imagery);

/// A ground's imagery on the grid of one of its levels, in its own depth. Throws as open_gray and open_gray_on_grid.
GraySource open_gray(const Ground& ground, const GridLevel& level);

/// The same with its colours. Throws as open_colors and open_colors_on_grid.
ColorSource open_colors(const Ground& ground, const GridLevel& level);

/// A colour picture of the ground around all tiles, at most `max_side_px` on its longer side: what a person looks at.
/// Throws as read_rgb8_on_grid.
Raster read_overview(const Ground& ground, int max_side_px);

}  // namespace pilotage
