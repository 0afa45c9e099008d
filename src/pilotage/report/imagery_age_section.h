#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/verdict/imagery_age.h"

namespace pilotage {

/// The section of the page; "" without a time of the flight.
std::string imagery_age_html(const std::optional<ImageryAge>& age);

/// As it stands in report.json.
nlohmann::ordered_json imagery_age_json(const ImageryAge& age);

}  // namespace pilotage
