#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/raster/licence.h"

namespace pilotage {

/// Adds the keys `prefix`licence and `prefix`attribution to an object; what is not known does not stand there.
void add_licence(const Licence& licence, nlohmann::ordered_json& json, const std::string& prefix = "");

/// Reads them back. Throws DataError as JsonObject::text.
Licence licence_from_json(JsonObject& object, const std::string& prefix = "");

}  // namespace pilotage
