#pragma once

#include <string>
#include <string_view>

namespace pilotage {

/// Before a text is parsed, which takes many times its size in memory: throws DataError, naming the number and the
/// remedy, when it holds more than kMaxRouteVertices positions as far as its marks tell (which may count somewhat
/// fewer, never many more), or more values than so many positions need.
void check_json_route_size(const std::string& name, std::string_view text);
void check_gpx_size(const std::string& name, std::string_view text);
void check_kml_size(const std::string& name, std::string_view text);
void check_wpl_size(const std::string& name, std::string_view text);

/// The same of positions that were counted.
void check_position_count(const std::string& name, std::size_t positions);

}  // namespace pilotage
