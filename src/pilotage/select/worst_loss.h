#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pilotage/mission/selection.h"
#include "pilotage/select/route_probability.h"

namespace pilotage {

/// The samples at which the loss of GNSS is looked at, ascending: every k-th of the route and the first of each leg. k
/// is the smallest with which the flights from the former on have at most 60,000 samples together; of the legs every
/// m-th is taken where theirs would have more. Each flight counts `cases` times, once for each case that it is
/// predicted in. Never the last sample, unless it is the only one.
std::vector<std::size_t> loss_samples(const Mission& mission, std::size_t cases = 1);

/// Looks at the loss of GNSS for good at each of loss_samples(): the largest predicted error if every fix came over
/// samples with `stored[i]`, and with a `path` the P to stay within the limit to the end of the route, `levels` being
/// the chances of all tries along it at each level of the place. With GNSS the flights up to the losses are one, and
/// are flown once. The worst point is one with an error beyond the limit, of those the one with the smallest P, of
/// those with the largest error; of points within 0.001 and 0.1 m of it the first. Because GNSS only ever adds to what
/// a flight knows, that is the first point of the route, but for what merging rounds (route_probability.h).
LossAnywhere lose_gnss_anywhere(const Mission& mission, const std::vector<bool>& stored, const FlightPath* path,
                                std::span<const LevelChances> levels, double max_error_m, double fix_interval_s,
                                int threads);

}  // namespace pilotage
