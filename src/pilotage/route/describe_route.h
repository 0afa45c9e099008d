#pragma once

#include <string>

#include "pilotage/route/route.h"

namespace pilotage {

/// The route for a person: format, home, length, heights, speeds, each vertex, what each item became, the notes. Lines
/// end with '\n'. Long lists (more than `max_rows` rows) are cut in the middle and say so.
std::string describe_route_text(const Route& route, std::size_t max_rows = 60);

}  // namespace pilotage
