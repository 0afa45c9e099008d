#pragma once

#include <vector>

namespace pilotage {

/// A band of heights above ground that one level serves.
struct AglBand {
  double min_agl_m = 0;
  double max_agl_m = 0;
  double typical_agl_m = 0;  ///< Geometric mean of both.
};

/// Splits the heights above ground (at least one, all positive) into the fewest bands of equal ratio such that no band
/// spans more than a factor of 2: the footprint of the lowest frame is then at least 0.7 of the tile's side, that of
/// the highest at most 1.4. Ascending; those that none of the heights lies in are left out, others share their limit
/// with their neighbour.
std::vector<AglBand> agl_bands(const std::vector<double>& agl_m);

/// The band that serves a height: the first whose max_agl_m is not below it, or the last.
int band_of(const std::vector<AglBand>& bands, double agl_m);

}  // namespace pilotage
