#pragma once

#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/mission/mission.h"
#include "pilotage/raster/color_source.h"

namespace pilotage {

/// Fills vegetation_share, water_share and aperture of the scored tiles of `matrix`. Throws as measure_ground_cover.
void add_ground_cover(const ColorSource& colors, const TileMatrix& matrix, std::vector<TileScore>& scores, int threads,
                      const Progress& progress);

/// Fills relief_m of tiles (score i belongs to tile i): highest minus lowest of 9 x 9 heights spread over the tile. NaN
/// where one of them is not known. Throws as Elevation.
void add_relief(const Mission& plan, const std::vector<const GroundTile*>& tiles, std::vector<TileScore>& scores);

}  // namespace pilotage
