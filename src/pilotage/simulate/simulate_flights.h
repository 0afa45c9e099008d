#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/base/statistics.h"
#include "pilotage/flightlog/match_evaluation.h"
#include "pilotage/simulate/fly_mission.h"
#include "pilotage/simulate/rendered_options.h"

namespace pilotage {

/// A share of flights, with its exact 95 % interval (base/statistics.h); NaN and [0, 1] of none.
struct SimulatedShare {
  std::int64_t of = 0;
  std::int64_t count = 0;
  Interval interval{0, 1};

  double share() const;
};
SimulatedShare simulated_share(std::int64_t count, std::int64_t of);

struct SimulatedLeg {
  int leg = 0;
  double planned_p = 0;   ///< LegStatus::p_within_limit; NaN where no flight of the plan reaches it.
  SimulatedShare within;  ///< Of the flights that reached it within the limit, those that left it so.
};

/// What the errors are where the route has come so far, over all flights.
struct SimulatedMark {
  double distance_m = 0;
  double p_within = 0;  ///< Share of the flights that were within the limit up to here, and knew it.
  double cep50_m = 0;   ///< Half of the true errors are at most so large;
  double r95_m = 0;     ///< 95 of 100. NaN below 60 flights, which do not bound it.
  double nees = 0;      ///< Mean; an honest filter's lies in nees_band in 95 of 100 simulations.
  Interval nees_band;
  std::int64_t lost = 0;  ///< Flights lost since the mark before.
};

/// The tries of a bin of predicted P (FoundByP).
struct SimulatedBin {
  double mean_p = 0;
  SimulatedShare found;  ///< Right fixes of tries, as if tries were independent; they are not, so it is too narrow.
};

/// What the matcher did with the frames of simulated flights.
struct RenderedSummary {
  RenderedOptions options;
  MatchEvaluation matches;  ///< Of all tries with a frame; the truth is the point straight below.
};

/// What `simulate` finds.
struct Simulation {
  std::int64_t flights = 0;
  std::uint64_t seed = 0;
  SimulateOptions options;
  double max_error_m = 0;
  double sigma_multiple = 3;
  double lost_from_m = 0;  ///< Where GNSS is lost first.
  double planned_p = 0;
  SimulatedShare within;       ///< The error stays within the limit all the way, and so does k·σ of the filter.
  SimulatedShare within_sure;  ///< k·σ of the filter stays within the limit: what the plan's P is of.
  SimulatedShare within_true;  ///< The true error stays within the limit, whatever the filter knows.
  SimulatedShare unaware;      ///< Flights that were off while the filter held itself within the limit.
  std::vector<SimulatedLeg> legs;
  std::vector<SimulatedMark> marks;
  TriedFixes fixes;                         ///< Sums over all flights.
  std::optional<RenderedSummary> rendered;  ///< Where fixes come from frames.
  std::vector<SimulatedBin> by_p;           ///< Bins with tries, ascending.
  std::vector<std::string> notes;           ///< Sentences.
  std::vector<std::string> not_simulated;   ///< Sentences.
};

/// Flies `options.flights` flights with fixes from `source`; one without begin_flight stands for the drawn ones, or
/// none, as the options say. Deterministic for any number of threads when the source is. Throws as
/// make_simulated_mission, and Interrupted; UsageError when the options ask for a source that was not given.
Simulation simulate_flights(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                            const SimulateOptions& options, std::uint64_t seed, int threads, const Progress& progress,
                            const FixSource& source = {});

}  // namespace pilotage
