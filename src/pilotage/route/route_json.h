#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/route/route.h"

namespace pilotage {

/// The route as JSON (schemas/route.json): what is not known (NaN) is left out; numbers read back exactly.
nlohmann::ordered_json route_to_json(const Route& route);

/// The route of route_to_json. Strict: an unknown or missing key, a value of another type or outside its range, a leg
/// between vertices that do not exist throw DataError naming `name` and the path.
Route route_from_json(const nlohmann::ordered_json& json, const std::string& name);

}  // namespace pilotage
