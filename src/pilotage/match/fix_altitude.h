#pragma once

#include <cmath>
#include <limits>

#include "pilotage/match/match.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// How high the aircraft is, for the messages that carry a fix. A match knows the height above ground only: heights
/// of the ground come from an elevation model on board, or the altitude from a barometer. NaN = not known.
struct FixAltitude {
  double ellipsoid_m = std::numeric_limits<double>::quiet_NaN();  ///< Above the WGS 84 ellipsoid.
  double amsl_m = std::numeric_limits<double>::quiet_NaN();       ///< Above mean sea level.
  double sigma_m = std::numeric_limits<double>::quiet_NaN();      ///< Standard deviation of both.
};

/// The altitude of a fix over ground whose height is known above the ellipsoid, above mean sea level, or both (NaN:
/// not), with an error of `ground_sigma_m`.
inline FixAltitude altitude_over(const Fix& fix, double ground_ellipsoid_m, double ground_amsl_m,
                                 double ground_sigma_m) {
  return {ground_ellipsoid_m + fix.height_agl_m, ground_amsl_m + fix.height_agl_m,
          std::hypot(ground_sigma_m, fix.height_sigma_m)};
}

}  // namespace pilotage

#pragma GCC visibility pop
