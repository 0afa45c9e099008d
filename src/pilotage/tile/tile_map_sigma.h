#pragma once

#include "pilotage/ground/ground.h"

namespace pilotage {

/// Sets GroundTile::map_sigma_m of all tiles from what the imagery says of its own error (raster/map_sigma.h): the root
/// mean square over the tile, of the imagery that is on top there, kUnknownMapSigma_m of what says nothing; nothing for
/// a tile without imagery. Returns whether any of the imagery that is seen said something. Throws DataError, naming the
/// raster, when one cannot be read or holds what is no standard deviation.
bool measure_map_sigma(Ground& ground);

}  // namespace pilotage
