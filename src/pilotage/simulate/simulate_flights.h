#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/mission/simulation.h"
#include "pilotage/simulate/fly_mission.h"

namespace pilotage {

/// Flies `options.flights` flights with fixes from `source`; one without begin_flight stands for the drawn ones, or
/// none, as the options say. With drawn ones each is flown a second time with nothing but what the plan knows of.
/// Deterministic for any number of threads when the source is. Throws as make_simulated_mission, and Interrupted;
/// UsageError when the options ask for a source that was not given, and when `lost_every_km` comes with `lost_from_km`
/// or with a source, or names more than 200 places.
Simulation simulate_flights(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                            const SimulateOptions& options, std::uint64_t seed, int threads, const Progress& progress,
                            const FixSource& source = {});

}  // namespace pilotage
