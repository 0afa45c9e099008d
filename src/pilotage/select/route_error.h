#pragma once

#include <cstddef>
#include <vector>

#include "pilotage/mission/gnss_availability.h"
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

/// Propagates the inertial error (ins/ins_state.h) along the plan's samples at the route's speed. While `gnss` is had,
/// it holds the errors (hold_with_gnss); the profile holds the error just before GNSS comes back. With GNSS or without,
/// over each sample with `matchable[i]`, a fix of plan.flight.ins.fix_sigma_m is taken, at most one every
/// `fix_interval_s`. The error is k·σ of position along the worst direction, k = plan.flight.ins.sigma_multiple.
/// A gap runs from the last sample with a fix before a stretch without (or from where GNSS is lost) to the first sample
/// after it with a fix or GNSS (or the end).
RouteError predict_route_error(const Mission& mission, const GnssAvailability& gnss, const std::vector<bool>& matchable,
                               double max_error_m, double fix_interval_s);
/// With the GNSS that the plan assumes (gnss_availability).
RouteError predict_route_error(const Mission& mission, const std::vector<bool>& matchable, double max_error_m,
                               double fix_interval_s);

/// The largest error of each flight that has GNSS up to one of `losses`, samples in ascending order, and none from
/// there on: what predict_route_error with gnss_lost_at has in its profile. The way up to a loss is flown once for all.
std::vector<double> largest_errors_of_losses(const Mission& mission, const std::vector<std::size_t>& losses,
                                             const std::vector<bool>& matchable, double fix_interval_s);

/// The fewest samples at which a fix must be taken so that the error stays within `max_error_m` wherever that can be
/// done: fly on to the last matchable sample before the limit is reached, fix there, and so on (optimal for intervals
/// on a line). Where no fix can be had in time, the next matchable sample is taken. None is taken where the plan has
/// GNSS (gnss_availability). Ascending indices into plan.flight.samples.
std::vector<std::size_t> fewest_fix_samples(const Mission& mission, const std::vector<bool>& matchable,
                                            double max_error_m);

}  // namespace pilotage
