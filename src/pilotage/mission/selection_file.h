#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/mission/selection.h"

#pragma GCC visibility push(default)

namespace pilotage {

/// The selection as a file (schemas/selection.schema.json): what `select` writes and `build` and `report` read. Numbers
/// read back exactly.
nlohmann::ordered_json selection_to_json(const Selection& selection);

/// Strict: a missing, unknown or wrong key throws DataError naming `name` and the path.
Selection selection_from_json(const nlohmann::ordered_json& json, const std::string& name);

/// selection_from_json of a file. Throws DataError.
Selection read_selection(const std::filesystem::path& path);

}  // namespace pilotage

#pragma GCC visibility pop
