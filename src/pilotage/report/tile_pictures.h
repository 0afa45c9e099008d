#pragma once

#include <cstddef>

#include <opencv2/core.hpp>

#include "pilotage/base/progress.h"
#include "pilotage/ground/ground.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Small pictures of the tiles of a ground on one sheet, CV_8UC3 (red, green, blue): that of ground.tiles[i] is the
/// square of side_px pixels in column i % columns and row i / columns. Pixels without imagery are gray. Empty: no
/// pictures.
struct TilePictures {
  int side_px = 0;
  int columns = 1;
  cv::Mat sheet;

  cv::Rect place(std::size_t i) const {
    const int n = static_cast<int>(i);
    return {n % columns * side_px, n / columns * side_px, side_px, side_px};
  }
};

/// The side that keeps `tiles` pictures within 6 million pixels: 96, 64, 48 or 32 (whole JPEG blocks, so that pictures
/// do not run into each other); 32 up to 16 million pixels; 0 (no pictures) beyond.
int tile_picture_side_px(std::size_t tiles);

/// Reads every tile of the ground at the resolution of its picture, in place to half a pixel of it. What is not 8 bits
/// deep is stretched linearly between the 2nd and the 98th percentile of each channel over all pictures. The same for
/// any number of threads (0 = all cores). Throws DataError when the imagery cannot be read, Interrupted.
TilePictures read_tile_pictures(const Ground& ground, int threads = 0, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
