#pragma once

#include <vector>

#include "pilotage/mission/mission.h"

namespace pilotage {

/// Planned time from a sample to the next: length over the speed of the first. A leg has samples at both of its ends
/// (sample_route), so no step spans two speeds. NaN where that speed or a distance is not known.
double step_time_s(const FlightSample& from, const FlightSample& to);

/// The sum of all steps; 0 of fewer than two samples.
double flight_time_s(const std::vector<FlightSample>& samples);

}  // namespace pilotage
