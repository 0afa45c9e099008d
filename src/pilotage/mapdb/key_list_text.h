#pragma once

#include <string>

#include "pilotage/mapdb/key_list.h"

namespace pilotage {

/// The list that a text spells (schemas/key-list.md). Throws DataError beginning with `name` and the line.
KeyList parse_key_list(const std::string& text, const std::string& name);

}  // namespace pilotage
