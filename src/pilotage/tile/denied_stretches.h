#pragma once

#include <string>
#include <vector>

#include "pilotage/mission/mission.h"
#include "pilotage/route/ogr_areas.h"

namespace pilotage {

/// Where GNSS is denied, as a planner says it (TileOptions::denied): "all" (as if nothing were given), "anywhere", or
/// any number of stretches in kilometres along the route, "3.2-7.5", several joined by commas, and files of polygons.
/// An end up to 50 m behind the route's is taken as the route's, because distances are read with one decimal of a
/// kilometre. Stretches that overlap or touch become one. A file none of whose polygons the route enters is told in
/// `warnings`.
///
/// Throws UsageError for a text that is none of these, a stretch outside the route or with no length, and "all" or
/// "anywhere" beside others; DataError for files as read_areas(), and when the route enters no polygon and no stretch
/// is given.
GnssDenial read_denial(const std::vector<std::string>& given, const std::vector<FlightSample>& samples,
                       std::vector<std::string>& warnings);

/// The stretches of the route inside an area, in the order of the route, to the centimetre. Between samples the route
/// is straight in longitude and latitude.
std::vector<DeniedStretch> stretches_inside(const GeodeticArea& area, const std::vector<FlightSample>& samples);

}  // namespace pilotage
