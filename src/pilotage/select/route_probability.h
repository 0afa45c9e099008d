#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pilotage/ins/ins_state.h"
#include "pilotage/mission/gnss_availability.h"
#include "pilotage/mission/mission.h"
#include "pilotage/mission/selection.h"
#include "pilotage/select/fix_attempts.h"

namespace pilotage {

/// The plan's route with every step of its flight worked out once. The plan must outlive it.
struct FlightPath {
  const Mission* mission = nullptr;
  InsErrorModel model;
  std::vector<InsStep> steps;  ///< From each sample to the next; one fewer than samples.
  GnssAvailability gnss;       ///< That of the plan; may be replaced.
  double max_error_m = 0;
  double horizon_s = 0;  ///< Time from a fix to the limit; histories are told apart by the error after it.
};
FlightPath make_flight_path(const Mission& mission, double max_error_m);
/// hold_with_gnss() at a sample.
InsState held_with_gnss(const FlightPath& path, std::size_t sample, const InsState& state);

/// Flights that are still within the limit, had their last fix at the same sample and nearly the same error after it.
struct FlightBranch {
  std::size_t fix_sample = 0;  ///< Of the last fix, or where GNSS was had last when that is behind it.
  double probability = 0;
  InsState state;
  double fix_time_s = -std::numeric_limits<double>::infinity();  ///< Of the last fix, as state.time_s.
  std::int64_t window = -1;  ///< Of the last try. Its draw u is known to be in [u_low, u_high).
  double u_low = 0;
  double u_high = 1;
  bool fixed_on_stretch = false;  ///< On the stretch that fly_stretch() flies.
};

/// A stretch of flight, sample by sample.
struct FlightStretch {
  std::vector<double> p_within_limit;  ///< After each sample's error has been held against the limit.
  double p_fix = 0;                    ///< P of at least one fix on it while within the limit.
  std::vector<FlightBranch> branches;  ///< At sample `end`, before its error is judged; at the route's end as they are.
  std::vector<FlightBranch> fixes;     ///< The branches right after the fix that made them, by sample.
  /// Of each group of flights that was lost, the sample of the last fix and the one where it was lost.
  std::vector<std::pair<std::size_t, std::size_t>> losses;
};

/// The one branch at the route's first sample.
std::vector<FlightBranch> first_branches(const FlightPath& path);

/// Flies the samples [begin, end) with the flights of `branches`, which stand at sample `begin`; `p_fix[i]` is the P of
/// a correct fix at sample i, independent of each other (fix_attempts.h).
///
/// Forward recursion over "last fix at sample i" and what is known of the window's draw, exact for the probabilities.
/// What the fixes before i taught the filter matters, too: the branches that come to a fix at i are sorted by the error
/// they would have a horizon later, and those within 2 % of each other become one, with the mean of their covariances
/// weighted by probability (at most 12 groups; the 2 % are doubled until there are no more). Merging is that of the
/// generalised pseudo-Bayesian filter (G. Ackerson, K. Fu, On state estimation in switching environments, IEEE Trans.
/// Automatic Control 15(1), 1970). Because the update with a fix is concave in the covariance, what is carried is never
/// below the mean covariance of the flights it stands for (as B. Sinopoli et al., Kalman filtering with intermittent
/// observations, IEEE Trans. Automatic Control 49(9), 2004). Branches that hold less than 1e-9 of the flights count as
/// lost. Where GNSS is had it holds the errors of each branch (hold_with_gnss), and fixes are taken as elsewhere.
FlightStretch fly_stretch(const FlightPath& path, const RouteChances& chances, std::size_t begin, std::size_t end,
                          std::vector<FlightBranch> branches);

/// What the route's chances are.
struct RouteSurvival {
  std::vector<double> p_within_limit;      ///< One for each sample.
  std::vector<double> leg_p_within_limit;  ///< One for each leg, as LegStatus.
  std::vector<double> leg_p_fix;
  /// Of each leg, at each level: at its first sample, before its error is judged.
  std::vector<std::vector<std::vector<FlightBranch>>> leg_entries;
  std::vector<double> p_at_level;  ///< P within the limit at the route's end, at each level.
  std::optional<WorstStretch> worst;
};

/// The flight at each level of the place, which all its tries share, and the mean over the levels: of P within the
/// limit at each sample, and of what both of a leg's numbers are the ratios of. The worst stretch is that over which
/// the mean falls most. One flight meets one level, so that a chain of tries is worth less than if each met its own.
RouteSurvival predict_survival(const FlightPath& path, std::span<const LevelChances> levels);
RouteSurvival predict_survival(const FlightPath& path, const RouteChances& chances);  ///< At a single level.

}  // namespace pilotage
