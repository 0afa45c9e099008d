#pragma once

#include <cstdint>
#include <numeric>
#include <vector>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/gray_source.h"

namespace pilotage::testing {

/// Level 0 of a pyramid over the whole source, in its own pixels.
inline TileMatrix matrix_over(const GraySource& source, int tile_size_px, int stride_px) {
  return {0, source.map_from_pixel, source.width_px, source.height_px, tile_size_px, stride_px};
}

/// The index of every tile, in order.
inline std::vector<std::int64_t> all_tiles(const TileMatrix& matrix) {
  std::vector<std::int64_t> indices(static_cast<std::size_t>(matrix.tile_count()));
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

}  // namespace pilotage::testing
