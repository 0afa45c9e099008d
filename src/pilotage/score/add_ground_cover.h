#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/ground.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/raster/color_source.h"

namespace pilotage {

/// Fills vegetation_share, water_share and aperture of the scored tiles of `matrix`: scores[i] is of the tile with
/// index tile_indices[i]. `white` is white_of() the colours, measured with the first tile
/// that needs it. Throws as measure_ground_cover.
void add_ground_cover(const ColorSource& colors, std::optional<double>& white, const TileMatrix& matrix,
                      std::span<const std::int64_t> tile_indices, std::span<TileScores> scores, int threads,
                      const Progress& progress);

/// Fills relief_m of tiles of a ground (scores[i] is of tiles[i]), where it has elevation: highest minus
/// lowest of 9 x 9 heights spread over the tile. NaN where one of them is not known. Throws as Elevation.
void add_relief(const Ground& ground, std::span<const GroundTile> tiles, std::span<TileScores> scores);

}  // namespace pilotage
