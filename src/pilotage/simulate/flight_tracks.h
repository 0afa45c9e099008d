#pragma once

#include <filesystem>
#include <vector>

#include "pilotage/mission/mission.h"
#include "pilotage/raster/gdal_vector.h"
#include "pilotage/simulate/simulate_flights.h"

namespace pilotage {

/// What a simulation says, as layers of a map in degrees:
///   tracks       where its first flights truly were, and where their navigation found them;
///   true_places  at each mark the ellipse that holds 95 of 100 flights, with the figures of the mark.
std::vector<VectorLayer> simulation_layers(const Mission& mission, const Simulation& simulation);

/// Writes them as a GeoPackage or as KML, by the name's end: .gpkg or .kml. Throws UsageError on another one, DataError
/// as write_geopackage and write_file.
void write_flight_tracks(const std::filesystem::path& path, const Mission& mission, const Simulation& simulation,
                         bool overwrite);

/// Throws UsageError unless `path` ends as write_flight_tracks asks for: before the work.
void check_track_file(const std::filesystem::path& path);

}  // namespace pilotage
