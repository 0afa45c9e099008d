#pragma once

#include <vector>

#include "pilotage/report/report.h"

namespace pilotage {

/// Stretches of the route over selected tiles: from the first matchable sample of a run to the first that is not, or
/// the last.
std::vector<FixStretch> fix_stretches(const std::vector<ErrorSample>& profile);

/// At most `max_samples` (≥ 8) samples that draw the same curve: the profile is cut into stretches of equal numbers of
/// samples, and of each the first, the last and those with the smallest and the largest error are kept. NaN counts as
/// the largest.
std::vector<ErrorSample> thin_profile(const std::vector<ErrorSample>& profile, std::size_t max_samples);

}  // namespace pilotage
