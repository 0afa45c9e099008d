#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/route/route.h"
#include "pilotage/route/route_options.h"

namespace pilotage {

/// Is it a mission as QGroundControl saved it before plans (.mission): an object with items and a planned home, and
/// neither a fileType nor a mission?
bool is_qgc_mission(const nlohmann::ordered_json& json);

/// A QGroundControl .mission of version "1.0" (QGroundControl 2.9 and 3.0): `items` with command, frame, id, param1 …
/// param4 and coordinate [latitude, longitude, altitude], and plannedHomePosition of the same form. Throws DataError
/// for other versions and for complex items (surveys), which say what to do: open it in QGroundControl and save a
/// .plan.
Route parse_qgc_mission(const std::string& name, const nlohmann::ordered_json& json, const RouteOptions& options);

}  // namespace pilotage
