#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/reroute/reroute.h"

namespace pilotage {

/// schemas/reroute.schema.json.
nlohmann::ordered_json reroute_to_json(const RerouteResult& result);

/// The planned and the new line, and the no-fly zones, as features of RFC 7946.
nlohmann::ordered_json reroute_to_geojson(const RerouteResult& result);

/// "+0.42 km, +23 s, 3 turns more": what the new line costs.
std::string cost_text(const RerouteResult& result);

}  // namespace pilotage
