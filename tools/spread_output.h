#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/registration/fit_warp.h"

namespace pilotage {

/// "0.97 m median, 5.57 m 95 %, 8.78 m largest", or "not known".
std::string spread_text(const Spread& spread);

/// Its three numbers, null where not known.
nlohmann::ordered_json spread_json(const Spread& spread);

}  // namespace pilotage
