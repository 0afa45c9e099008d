#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/mission/mission.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The tile plan as a file (schemas/plan.schema.json): what `tile` writes and `score`, `select`, `build` and `report`
/// read. Numbers read back exactly.
nlohmann::ordered_json plan_to_json(const Mission& mission);

/// Strict: a missing, unknown or wrong key throws DataError naming `name` and the path.
Mission plan_from_json(const nlohmann::ordered_json& json, const std::string& name);

/// plan_from_json of a file. Throws DataError.
Mission read_plan(const std::filesystem::path& path);

}  // namespace pilotage

#pragma GCC visibility pop
