#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "pilotage/base/progress.h"
#include "pilotage/geo/bounds.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/registration/registration_options.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// A place of the reference that was found again in the second date.
struct Tie {
  Eigen::Vector2d point_m = Eigen::Vector2d::Zero();         ///< In the reference, CRS of the grid.
  Eigen::Vector2d displacement_m = Eigen::Vector2d::Zero();  ///< The second date shows the same ground at point + this.
  double gsd_m = 1;  ///< Of the pixels it was found on, by which its error goes.
  double ncc = 0;
  double margin = 0;  ///< ncc − that of the best rival outside the main lobe.
  /// Found with shadows, and taken because it lies near the field of those without: says nothing of that field's error.
  bool is_confirmed = false;
};

struct TieSearch {
  std::vector<Tie> ties;    ///< By row of places, then column.
  std::int64_t places = 0;  ///< Places with ground in both dates, where a tie was looked for.
};

/// On pixels as large shadows are hardly more than one of them, and are correlated like everything else.
inline constexpr double kShadowPixels_m = 2;

/// Whether ties on pixels of `gsd_m` are looked for without what is dark (lit_ground.h).
inline bool leaves_shadows_out(const TieOptions& options, double gsd_m) {
  return options.shadows == TieShadows::kIgnore && gsd_m < kShadowPixels_m;
}

/// Which parts of the grid matter; empty = all of it.
using Wanted = std::function<bool(const Bounds& around_m)>;

/// Ties on a regular grid of places: at each, the normalised cross-correlation of the reference's square of template_px
/// with the second date within ±radius_px (masked where either lacks ground, D. Padfield 2012), and its peak to a
/// fraction of a pixel by a quadratic through the nine values around it. A tie is kept when its peak is not on the
/// edge, reaches min_ncc, exceeds every rival outside the main lobe (correlation_peaks.h) by min_margin, and the second
/// date's square at the peak, looked for in the reference within the same radius, comes back within max_backward_px
/// (cross-check, P. Fua, Machine Vision and Applications 6, 1993). Where leaves_shadows_out(), what is dark
/// against its surroundings takes no part in the correlation, and 30 % of a square must be lit in both dates;
/// min_valid_fraction then holds for the square's own place alone.
///
/// Both sources have the same north-up grid of square pixels in metres; any depth. Only a strip of the rows around one
/// row of places is in memory. The same result for any number of threads. Throws UsageError when the grids differ, are
/// not as said, or an option is out of range; what the sources throw; Interrupted.
TieSearch find_ties(const GraySource& reference, const GraySource& second, int radius_px, const TieOptions& options,
                    const Wanted& wanted = {}, int threads = 0, const Progress& progress = {});

}  // namespace pilotage

#pragma GCC visibility pop
