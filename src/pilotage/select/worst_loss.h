#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pilotage/mission/selection.h"
#include "pilotage/select/route_probability.h"

namespace pilotage {

/// The samples at which the loss of GNSS is looked at, ascending: every k-th of the route and the first of each leg. k
/// is the smallest with which the flights from the former on have at most 60,000 samples together; of the legs every
/// m-th is taken where theirs would have more. Never the last sample, unless it is the only one.
std::vector<std::size_t> loss_samples(const Mission& mission);

/// What tries give, as in RouteChances, before it is known where GNSS is lost.
struct LossTries {
  const FlightPath* path = nullptr;
  std::vector<double> p_of_tile;  ///< Of the tiles that are stored; 0 of the others.
  std::optional<double> decorrelation_m;
};

/// Looks at the loss of GNSS for good at each of loss_samples(): the largest predicted error if every fix came over
/// samples with `stored[i]`, and with `tries` the P to stay within the limit to the end of the route. The worst point
/// is one with an error beyond the limit, of those the one with the smallest P, of those with the largest error, the
/// first of equals. `tiles` are those under the route (tiles_under_route).
LossAnywhere lose_gnss_anywhere(const Mission& mission, const std::vector<std::optional<std::size_t>>& tiles,
                                const std::vector<bool>& stored, const std::optional<LossTries>& tries,
                                double max_error_m, double fix_interval_s);

}  // namespace pilotage
