#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/gray_source.h"

// The contrast of what is about as large as the pattern of a descriptor: corners, edges, roofs; not how dark a wood is
// beside a field. What was tried beside it: docs/methods/matchability.md.

namespace pilotage {

/// Fine contrast of each tile, in gray levels: the mean over its ground of |mean of 3 × 3 px − mean of 15 × 15 px|,
/// both means over ground alone, within the tile's surroundings. NaN without ground. Result i belongs to
/// `tile_indices[i]`, index = row · matrix_width + column of `matrix`, whose pixel grid is that of `shown` (CV_8U:
/// stretch_to_8bit).
///
/// Streams groups of neighbouring tiles of about 1,000 × 1,000 px, one per thread in memory. Integer arithmetic, to
/// 1/256 of a level: the result depends neither on `threads` (0 = all cores) nor on which other tiles are asked for.
/// Throws UsageError when `shown` is not CV_8U, DataError when the matrix is not that of its grid or reading fails;
/// Interrupted.
std::vector<double> measure_fine_contrast(const GraySource& shown, const TileMatrix& matrix,
                                          std::span<const std::int64_t> tile_indices, int threads = 0,
                                          const Progress& progress = {});

/// The fine contrast that ground of a map usually has at the scale of its tiles: the median over up to 12 × 12 windows
/// of `side_px`, spread evenly over the source. A window counts when half of it is ground and FAST finds as many
/// corners in it as a fix needs features, so that a lake or a sea that fills half of the imagery does not make its
/// shores look rich. NaN when no window counts.
///
/// `shown` is the map in 8 bits (stretch_to_8bit). The result depends on the source and the side alone, not on which
/// tiles are scored: every shard of a run finds the same; nor on `threads` (0 = all cores). In memory is one window for
/// each. Throws what the source throws, UsageError when it is not CV_8U or side_px < 1; Interrupted.
double usual_fine_contrast(const GraySource& shown, int side_px, int threads = 0, const Progress& progress = {});

}  // namespace pilotage
