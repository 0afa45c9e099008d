#pragma once

#include <vector>

#include "pilotage/mission/mission.h"

namespace pilotage {

/// Planned time from a sample to the next. The speed of either is that of the leg: a leg has samples at both of its
/// ends, so none spans two.
double step_time_s(const FlightSample& from, const FlightSample& to);

/// Planned time from the first sample to the last; NaN where a speed is not known.
double flight_time_s(const std::vector<FlightSample>& samples);

}  // namespace pilotage
