#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace pilotage::testing {

/// The first violation of a schema of ours, named relative to schemas/ ("report.schema.json", "results/tile.json"), or
/// "". References to other files are followed. Throws std::runtime_error for a reference that leads nowhere.
std::string schema_violation(const std::string& schema_name, const nlohmann::ordered_json& json);

}  // namespace pilotage::testing
