#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/mission/simulation.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// simulation.json (schemas/simulation.schema.json): what `simulate` writes and `report --simulation` reads.
nlohmann::ordered_json simulation_to_json(const Simulation& simulation);

/// Strict: a missing, unknown or wrong key throws DataError naming `name` and the path.
Simulation simulation_from_json(const nlohmann::ordered_json& json, const std::string& name);

/// What a simulation of these files is held to: their digests, as roles plan, table and selection. Throws DataError
/// when one cannot be read.
std::vector<InputFile> simulated_inputs(const std::string& plan, const std::string& table,
                                        const std::string& selection);

/// simulation_from_json of a file. Throws DataError.
Simulation read_simulation(const std::filesystem::path& path);

/// The same for people: whole lines.
std::string simulation_text(const Simulation& simulation);

/// "0.928 [0.910, 0.943]"
std::string share_text(const Share& share);

}  // namespace pilotage

#pragma GCC visibility pop
