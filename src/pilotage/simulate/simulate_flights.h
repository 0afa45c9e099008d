#pragma once

#include <cstdint>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/mission/simulation.h"
#include "pilotage/simulate/fly_mission.h"

namespace pilotage {

/// Flies `options.flights` flights, and each a second time with nothing but what the plan knows of. Deterministic for
/// any number of threads. Throws as make_simulated_mission, UsageError when `lost_every_km` comes with `lost_from_km`
/// or names more than 200 places, and Interrupted.
Simulation simulate_flights(const Mission& mission, const std::vector<TileScores>& scores, const Selection& selection,
                            const SimulateOptions& options, std::uint64_t seed, int threads, const Progress& progress);

}  // namespace pilotage
