#pragma once

#include <cstdint>
#include <functional>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/raster/raster.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A grid of colours of any size that is read window by window: the colour counterpart of GraySource.
struct ColorSource {
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  GeoTransform map_from_pixel;
  Crs crs;           ///< As of GraySource.
  int channels = 3;  ///< 3: red, green, blue. 1: the imagery has one band, colours are not known.
  int depth = 0;     ///< OpenCV depth of what `read` returns: CV_8U, CV_16U or CV_64F.

  /// The pixels of a window that lies inside the grid: `channels` channels of type `depth`, values as stored (nothing
  /// is stretched, so ratios of bands mean something). May be called by several threads at a time. Throws DataError
  /// when the data cannot be read.
  std::function<Raster(const PixelWindow& window)> read;

  /// As of GraySource.
  int block_width_px = 1;
  int block_height_px = 1;
};

/// BT.601 luma of one or three channels (red, green, blue); one channel is gray already. 8 and 16 bits as cv::cvtColor
/// rounds it, all others 0.299 R + 0.587 G + 0.114 B in double precision.
cv::Mat gray_from_colors(const cv::Mat& pixels);

/// The same grid in gray: what open_gray and open_gray_on_grid give for the same imagery.
GraySource gray_source_of(const ColorSource& colors);

/// The same imagery in gray and in colour.
struct GrayAndColors {
  GraySource gray;
  ColorSource colors;
  /// About how many pixels of the grid, the last ones read as gray or as colours, stay in memory for whoever reads them
  /// next in either way; 0 where each has to be made for itself.
  std::int64_t kept_px = 0;
};

}  // namespace pilotage

#pragma GCC visibility pop
