#pragma once

#include <Eigen/Core>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/match/match.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// What a frame alone says of the aircraft's position.
struct PositionMeasurement {
  GeodeticPoint position;
  /// With the map's own error, which is not white: frames over the same ground share it.
  Eigen::Matrix2d covariance_en_m2 = Eigen::Matrix2d::Zero();
  /// Of that error, each axis, as far as fixes share it: Fix::map_sigma_m, and 0 where several maps were asked.
  double map_sigma_m = 0;
};

/// A fix with the prior's position taken out of it again: match() lets the prior position take part, so a filter that
/// gave the prior would count it twice. In information form, which is how the prior went in:
///   C⁻¹ = C_fix⁻¹ − C_prior⁻¹,   C⁻¹ (x − prior) = C_fix⁻¹ (fix − prior)
/// with the map's variance taken off C_fix before and added to C after. Directions about which the frame says next to
/// nothing get the variance 10⁶ times the prior's.
PositionMeasurement without_prior(const Fix& fix, const MatchPrior& prior);

/// The covariance for a filter that follows the aircraft on the map, with no state for the map's error: without what
/// all fixes on it share. Of the map's error kUnknownMapSigma_m counts as differing from fix to fix, the rest as
/// shared.
Eigen::Matrix2d covariance_within_map(const PositionMeasurement& measurement);

/// A right fix lies farther from what a filter expects (squared Mahalanobis distance of the innovation) one time in a
/// thousand: χ² of two degrees of freedom, −2 ln 0.001.
inline constexpr double kInnovationGateChiSquared = 13.815510557964274;

}  // namespace pilotage

#pragma GCC visibility pop
