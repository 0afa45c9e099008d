#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/replay/replay.h"

namespace pilotage {

/// replay.json (schemas/replay.schema.json).
nlohmann::ordered_json replay_to_json(const Replay& replay);

/// The same for people, one line per thing.
std::string replay_text(const Replay& replay);

}  // namespace pilotage
