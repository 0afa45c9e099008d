#pragma once

#include <functional>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/crs.h"
#include "pilotage/raster/raster.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A grid of gray pixels of any size that is read window by window, so that imagery larger than memory streams.
struct GraySource {
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  GeoTransform map_from_pixel;
  Crs crs;        ///< Of map_from_pixel; empty for pixels in memory whose place nobody asked for.
  int depth = 0;  ///< OpenCV depth of what `read` returns: CV_8U, CV_16U or CV_64F (everything else is widened to it).

  /// The pixels of a window that lies inside the grid, as one channel of type `depth`. May be called by several threads
  /// at a time. Throws DataError when the data cannot be read.
  std::function<Raster(const PixelWindow& window)> read;

  /// The pixels lie in blocks of this size, counted from the first pixel, each of which is decoded (or warped) as a
  /// whole by each thread that reads a part of it: who reads along their borders reads each once. 1 where any window
  /// costs the same.
  int block_width_px = 1;
  int block_height_px = 1;
};

/// A source over pixels already in memory (shared, not copied).
GraySource gray_source_from(const Raster& raster);

}  // namespace pilotage

#pragma GCC visibility pop
