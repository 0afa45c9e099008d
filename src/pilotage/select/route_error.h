#pragma once

#include <cstddef>
#include <vector>

#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"

namespace pilotage {

struct RouteError {
  std::vector<ErrorSample> profile;  ///< One entry for each sample of the plan; the error just before a fix there.
  std::vector<RouteGap> gaps;        ///< Stretches without a fix, in the order of the route.
  std::vector<LegStatus> legs;       ///< One entry for each leg of the route.
  double matchable_fraction = 0;     ///< Of the route's length.
  bool within_limit = true;
};

/// Propagates the inertial error (ins/ins_state.h) along the plan's samples at the route's speed. GNSS is lost at the
/// start of the route; over each sample with `matchable[i]` a fix of plan.flight.ins.fix_sigma_m is taken, at most one
/// every `fix_interval_s`. The error is k·σ of position along the worst direction, k = plan.flight.ins.sigma_multiple.
/// A gap runs from the last matchable sample before a stretch without matchable ground (or the start) to the first one
/// after it (or the end).
RouteError predict_route_error(const Mission& mission, const std::vector<bool>& matchable, double max_error_m,
                               double fix_interval_s);

/// The fewest samples at which a fix must be taken so that the error stays within `max_error_m` wherever that can be
/// done: fly on to the last matchable sample before the limit is reached, fix there, and so on (optimal for intervals
/// on a line). Where no fix can be had in time, the next matchable sample is taken. Ascending indices into
/// plan.flight.samples.
std::vector<std::size_t> fewest_fix_samples(const Mission& mission, const std::vector<bool>& matchable,
                                            double max_error_m);

}  // namespace pilotage
