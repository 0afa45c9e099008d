#pragma once

#include <optional>
#include <string>

namespace pilotage {

/// Metres in a unit of height as rasters name it, in whatever case and with whatever between its words ("m", "ft",
/// "US_survey_foot", "foot (International)", "dm"); "" is the metre. EPSG's figures. Nothing when it is not known.
std::optional<double> metres_per_height_unit(const std::string& unit);

}  // namespace pilotage
