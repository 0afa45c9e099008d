#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/vision/feature_options.h"
#include "pilotage/vision/feature_set.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// Features of a map of any size, each once, computed over fixed blocks of kFeatureBlockPx pixels with the margin that
/// patches need; positions are pixels of the whole grid.
///
/// Corners are FAST-9 (E. Rosten, T. Drummond, ECCV 2006) with 3 × 3 non-maximum suppression at `fast_threshold`, in
/// cells of about eight features; a cell that does not fill its share is searched again at `min_fast_threshold`. In
/// each cell the corners with the highest Harris response (C. Harris, M. Stephens, 1988; 7 × 7 Sobel window, k = 0.04)
/// stay. Octaves are area averages of the image. Descriptors are those of descriptor_of(options), all upright.
///
/// No feature's patch touches an invalid pixel or leaves the grid, so small grids have none. Only blocks that touch one
/// of `windows` are read, and only features inside at least one window are returned; the features of a piece of ground
/// do not depend on the windows. `threads` = 0 uses all cores and gives the same result as 1. Order: block (row by
/// row), then octave, y, x. Memory: a few megabytes per thread besides the result. Throws UsageError when the source is
/// not CV_8U of one channel, when a window has a negative size, or for bad options; what the source throws;
/// Interrupted.
FeatureSet extract_features_of_map(const GraySource& source, const std::vector<PixelWindow>& windows,
                                   const FeatureOptions& options, int threads = 0, const Progress& progress = {});

inline constexpr int kFeatureBlockPx = 512;

}  // namespace pilotage

#pragma GCC visibility pop
