#pragma once

#include <optional>

#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {

// What a list says of a time between two of its records, no further than `reach_s` from either, linearly; nothing where
// it says nothing. Lists in the order of their times.

std::optional<LoggedPosition> position_at(const std::vector<LoggedPosition>& positions, double time_s, double reach_s);
/// The angles each by its shorter way.
std::optional<Attitude> attitude_at(const std::vector<LoggedAttitude>& attitudes, double time_s, double reach_s);
std::optional<double> height_at(const std::vector<LoggedHeight>& heights, double time_s, double reach_s);

}  // namespace pilotage
