#pragma once

#include "pilotage/ins/ins_error_model.h"
#include "pilotage/ins/ins_state.h"

namespace pilotage {

/// The longest time of straight flight after a fix of error `fix_sigma_m` during which k·σ of position stays within
/// `max_error_m`: the first crossing to 1 ms. 0 when the fix itself is worse than that; kLongestGap_s when it is never
/// reached. Throws UsageError unless all arguments are positive and finite.
double longest_bridgeable_gap_s(const InsErrorModel& model, double speed_mps, double max_error_m, double sigma_multiple,
                                double fix_sigma_m);

inline constexpr double kLongestGap_s = 86400;

/// Radius around the predicted position that a search must cover so that the ground seen is inside (methods.md, section
/// 4):
///   position error + half the footprint's diagonal + height · tan(tilt error).
/// Infinite when the tilt error reaches 90°. All arguments at least 0.
double search_radius_m(double position_error_m, double half_footprint_m, double agl_m, double tilt_error_rad);

}  // namespace pilotage
