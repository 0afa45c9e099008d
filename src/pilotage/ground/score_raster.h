#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/score_table.h"
#include "pilotage/raster/gdal_write.h"

namespace pilotage {

/// Scores as a raster: one pixel per tile, drawn as the stride-sized cell around the tile's centre.
struct ScoreRaster {
  std::vector<ScoreBand> bands;  ///< valid_fraction, then measures() by name; NaN where there is no tile.
  GeoTransform map_from_pixel;
};

/// The raster of the tiles of one level, cropped to the tiles there are; measures that no tile has a value for are left
/// out. Empty bands when the level has no tile. Throws DataError when a tile lies outside the level's matrix.
ScoreRaster score_raster(const ScoreTable& table, int level);

/// One byte per tile on the same pixels, kNoClass where there is no tile; empty when the level has no tile. Throws as
/// score_raster.
cv::Mat class_raster(const ScoreTable& table, int level,
                     const std::function<std::uint8_t(const TileScores&)>& class_of);

}  // namespace pilotage
