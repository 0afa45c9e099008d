#pragma once

#include <vector>

#include "pilotage/geo/geodetic_point.h"
#include "pilotage/mission/mission.h"

namespace pilotage {

/// The point of a sampled route `distance_m` along it, by linear interpolation between the two samples around it
/// (samples lie a few metres apart: the error is below a millimetre away from the poles); the nearer end outside the
/// route. lon in [-180, 180). `samples` is sorted by distance; NaN when it is empty.
GeodeticPoint route_point_at(const std::vector<FlightSample>& samples, double distance_m);

/// The route from one distance to another: both ends, and every `step`-th sample between them so that at most
/// `max_points` points come back (at least 2).
std::vector<GeodeticPoint> route_line_between(const std::vector<FlightSample>& samples, double from_distance_m,
                                              double to_distance_m, std::size_t max_points);

/// The line of a leg: its own samples only, thinned in the same way with both ends kept; empty when it has none.
std::vector<GeodeticPoint> leg_line(const std::vector<FlightSample>& samples, int leg, std::size_t max_points);

}  // namespace pilotage
