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
#include "pilotage/select/flown_steps.h"

namespace pilotage {

/// A wind at a level of the place: neither is known before the flight, and both stay as they are all the way.
struct FlightCase {
  std::size_t level = 0;  ///< Index into the levels that a flight is predicted at.
  double weight = 1;      ///< Of the wind at that level.
  FlownSteps steps;
};

/// The plan's route with every step of its flight worked out once. The plan must outlive it.
struct FlightPath {
  const Mission* mission = nullptr;
  InsErrorModel model;            ///< With the error of the map.
  FlownSteps steps;               ///< Without wind.
  std::vector<FlightCase> cases;  ///< What the flight's chances are averaged over, by level.
  GnssAvailability gnss;          ///< That of the plan; may be replaced.
  double frames_that_come = 1;    ///< The others are dropped: a try with them fails.
  double max_error_m = 0;
  double horizon_s = 0;  ///< Time from a fix to the limit; histories are told apart by the error after it.
};

/// For chances at `levels` levels of the place, in wind_cases() of the plan's conditions. docs/methods/selection.md
/// says how near the mean over them comes to that over many.
FlightPath make_flight_path(const Mission& mission, double max_error_m, std::size_t levels = 1);

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
  bool fixed_on_stretch = false;                                     ///< On the stretch that fly_stretch() flies.
  Eigen::Matrix2d position_covariance_m2 = Eigen::Matrix2d::Zero();  ///< At the sample that fly_stretch() looks at.
};

/// Flights that came to an error beyond the limit.
struct LostFlights {
  std::size_t fix_sample = 0;  ///< Of their last fix.
  std::size_t lost_at = 0;
  double probability = 0;
};

/// A stretch of flight, sample by sample.
struct FlightStretch {
  std::vector<double> p_within_limit;  ///< After each sample's error has been held against the limit.
  double p_fix = 0;                    ///< P of at least one fix on it while within the limit.
  std::vector<FlightBranch> branches;  ///< At sample `end`, before its error is judged; at the route's end as they are.
  std::vector<LostFlights> losses;     ///< In the order of the flight.
};

/// The one branch at the route's first sample.
std::vector<FlightBranch> first_branches(const FlightPath& path);

/// Flies the samples [begin, end) by `steps` (of the path, or of one of its cases) with the flights of `branches`,
/// which stand at sample `begin`; `chances.p[i]` is the P of a correct fix at sample i on the line (fix_attempts.h),
/// off which a flight is by its position's error.
///
/// Forward recursion over "last fix at sample i" and what is known of the window's draw, exact for the probabilities.
/// What the fixes before i taught the filter matters, too: the branches that come to a fix at i are sorted by the error
/// they would have a horizon later, and those within 2 % of each other become one, with the mean of their covariances
/// weighted by probability (at most 8 groups; the 2 % are doubled until there are no more). So do neighbours of one fix
/// of which each holds less than 0.1 % of the flights still within, once they have come to another try. Merging is the
/// generalised pseudo-Bayesian filter's (G. Ackerson, K. Fu, On state estimation in switching environments, IEEE Trans.
/// Automatic Control 15(1), 1970). Because the update with a fix is concave in the covariance, what is carried is never
/// below the mean covariance of the flights it stands for (as B. Sinopoli et al., Kalman filtering with intermittent
/// observations, IEEE Trans. Automatic Control 49(9), 2004). Branches that hold less than 1e-9 of the flights count as
/// lost. Where GNSS is had it holds the errors of each branch (hold_with_gnss), and fixes are taken as elsewhere.
///
/// Of the tries with a frame that give no correct fix, the share RouteChances::false_fix_rate gives a false one, which
/// lies anywhere in the square of 3 σ to each side that the matcher searches; flights that it puts beyond the limit are
/// lost. That it may be refused is not counted on.
///
/// Between changes of GNSS the covariances are not flown sample by sample (ins/ins_span.h), and errors are held against
/// the limit where something happens: at tries, and else when alike steps have taken 10 s. Where one has come beyond
/// it, the sample is looked for at which it did; between, errors are taken to grow.
///
/// `fixes`, if not null, gets the branches right after the fix that made them, by sample.
FlightStretch fly_stretch(const FlightPath& path, const FlownSteps& steps, const RouteChances& chances,
                          std::size_t begin, std::size_t end, std::vector<FlightBranch> branches,
                          std::vector<FlightBranch>* fixes = nullptr);

/// What the route's chances are.
struct RouteSurvival {
  std::vector<double> p_within_limit;      ///< One for each sample.
  std::vector<double> leg_p_within_limit;  ///< One for each leg, as LegStatus.
  std::vector<double> leg_p_fix;
  /// Of each leg whose P is below what was asked for, in each case: at its first sample, before its error is judged.
  std::vector<std::vector<std::vector<FlightBranch>>> leg_entries;
  std::vector<double> p_at_level;  ///< P within the limit at the route's end, at each level.
  std::optional<WorstStretch> worst;
};

/// The flight in each case of the path, and the mean over them: of P within the limit at each sample, and of what both
/// of a leg's numbers are the ratios of. One flight meets one level of the place, which all its tries share, and one
/// wind, so that a chain of tries is worth less than if each met its own. The worst stretch is of the leg on which most
/// flights are lost, and there of the losses that overlap: from the last fix to where they are lost, the outermost 5 %
/// at either end left out. `levels` are as
/// many as the path was made for. Entries of legs are kept below `entries_below`.
RouteSurvival predict_survival(const FlightPath& path, std::span<const LevelChances> levels, int threads,
                               double entries_below = 0);
RouteSurvival predict_survival(const FlightPath& path, const RouteChances& chances);  ///< At a single level.

/// RouteProbability::interval; nothing at a single level.
std::optional<ProbabilityInterval> interval_over_levels(const RouteSurvival& survival);

}  // namespace pilotage
