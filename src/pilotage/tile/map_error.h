#pragma once

#include <vector>

#include "pilotage/mission/mission.h"
#include "pilotage/raster/gdal_imagery.h"

namespace pilotage {

/// A map is wrong by what the ground control points that place it miss, and by what its change of datum is uncertain,
/// and so is each fix that is taken on it: the error of a fix along one axis (Flight::ins) grows by the share of one
/// axis of the worst raster's, and a note says so.
void add_placement_error(const std::vector<ImageryInfo>& infos, Mission& mission);

/// How far the imagery may lie off, in Flight::conditions: as the planner says, else as it says itself, tile by tile.
/// Its largest error then counts all along the route, and is the same all along it: what all frames of a captured map
/// share does not average out on the way. Throws DataError as measure_map_sigma() does, and where imagery names a
/// raster of its error that does not exist.
void add_map_sigma(const FlightConditions& given, Mission& mission);

}  // namespace pilotage
