#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/base/options.h"

namespace pilotage {

/// Parses JSON text; throws DataError with `name`, line and column when it is not JSON, repeats a key, or
/// nests more than 100 deep.
nlohmann::ordered_json parse_json(const std::string& name, std::string_view text);

/// Writes the values of a JSON object into the fields of `list`. Strict: an unknown key (with the nearest known one),
/// a value of another type (3.7 for an integer, "1" for a number) or one outside its range throws UsageError naming
/// `name` and the path. Keys that start with "$" are left to schema tools.
void set_options_from_json(const OptionList& list, const nlohmann::ordered_json& json, const std::string& name);

/// The options as a nested JSON object in the order of description; unset optional fields are left out.
nlohmann::ordered_json options_to_json(const OptionList& list);

/// JSON Schema (2020-12) of the object that set_options_from_json accepts.
nlohmann::ordered_json options_schema(const OptionList& list, std::string_view title);

}  // namespace pilotage
