#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/reroute/reroute.h"

namespace pilotage {

/// schemas/reroute.schema.json.
nlohmann::ordered_json reroute_to_json(const RerouteResult& result);

/// The planned and the new line, and the no-fly zones, as features of RFC 7946.
nlohmann::ordered_json reroute_to_geojson(const RerouteResult& result);

/// A page with both lines over the ground that was searched, and their figures; it needs no network and no other file.
std::string reroute_to_html(const RerouteResult& result, const std::string& title);

/// "+0.42 km, +23 s, 3 turns more": what the new line costs.
std::string cost_text(const RerouteResult& result);

}  // namespace pilotage
