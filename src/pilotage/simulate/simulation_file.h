#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/simulate/simulate_flights.h"

namespace pilotage {

/// simulation.json (schemas/simulation.schema.json).
nlohmann::ordered_json simulation_to_json(const Simulation& simulation);

/// The same for people: whole lines.
std::string simulation_text(const Simulation& simulation);

}  // namespace pilotage
