#pragma once

#include <string>
#include <vector>

#include "pilotage/ground/ground.h"

namespace pilotage {

/// Sets GroundTile::map_sigma_m of all tiles from rasters of the imagery's own error (raster/map_sigma.h), later ones
/// on top: the root mean square over the tile, of what they cover; nothing where they cover nothing of it. Throws
/// DataError, naming the raster, when it cannot be read or holds what is no standard deviation up to 100 m.
void measure_map_sigma(const std::vector<std::string>& rasters, Ground& ground);

}  // namespace pilotage
