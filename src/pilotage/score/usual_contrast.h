#pragma once

#include "pilotage/raster/gray_source.h"

namespace pilotage {

/// The gray contrast that ground of a map usually has at the scale of its tiles: the median of σ/f̄ (standard deviation
/// over mean of the gray values) over up to 12 × 12 windows of `side_px`, spread evenly over the source. A window
/// counts when half of it is ground and FAST finds as many corners in it as a fix needs features, so that a lake or a
/// sea that fills half of the imagery does not make its shores look rich. NaN when no window counts.
///
/// `shown` is the map in 8 bits (stretch_to_8bit). The result depends on the source and the side alone, not on which
/// tiles are scored: every shard of a run finds the same. In memory is one window. Throws what the source throws, and
/// UsageError when it is not CV_8U or side_px < 1.
double usual_contrast(const GraySource& shown, int side_px);

}  // namespace pilotage
