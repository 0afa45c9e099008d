#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/raster/gdal_write.h"

namespace pilotage {

/// Scores as a raster: one pixel per tile, drawn as the stride-sized cell around the tile's centre.
struct ScoreRaster {
  std::vector<ScoreBand> bands;  ///< valid_fraction, then measures() by name; NaN where there is no tile.
  GeoTransform map_from_pixel;
};

/// The raster of the rows of one level, cropped to the tiles there are; columns that no row has a value for are left
/// out. Empty bands when there is no row. Throws DataError when a row lies outside `matrix`.
ScoreRaster score_raster(const TileMatrix& matrix, std::span<const TileRow> rows);

/// One byte per tile on the same pixels, kNoClass where there is no tile; empty when there is no row. Throws as
/// score_raster.
cv::Mat class_raster(const TileMatrix& matrix, std::span<const TileRow> rows,
                     const std::function<std::uint8_t(const TileRow&)>& class_of);

}  // namespace pilotage
