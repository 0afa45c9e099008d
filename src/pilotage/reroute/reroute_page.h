#pragma once

#include <string>

#include "pilotage/reroute/reroute.h"

namespace pilotage {

/// A page with both lines over the ground that was searched, and their figures, in the design of the report; it needs
/// no network and no other file. `title` is the planned line's name, `json_name` the file beside it with its numbers.
std::string reroute_to_html(const RerouteResult& result, const std::string& title, const std::string& json_name);

}  // namespace pilotage
