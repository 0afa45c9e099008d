#pragma once

#include <filesystem>
#include <string>

#include "pilotage/gis/report_layers.h"
#include "pilotage/report/report.h"

namespace pilotage {

// For Google Earth and QGroundControl. QGroundControl reads lines and polygons only, and a file that holds a polygon as
// polygons only (KMLHelper of its sources); of several it may take the first. So lines and areas are two files, and
// the whole route is the first line.

/// KML of the route, its legs by status, and the gaps.
std::string legs_kml(const Report& report, const ReportLayers& layers);

/// KML of the whole route and its waypoints, which are named by the numbers of the plan's items.
std::string route_kml(const Report& report, const ReportLayers& layers);

/// KML of the matching areas, the largest first.
std::string areas_kml(const Report& report, const ReportLayers& layers);

/// KMZ for Google Earth: the heat map of each level as ground overlays with a legend, route, legs, gaps, matching areas
/// and all tiles with their numbers; nothing outside the file is asked for. Throws DataError.
void write_kmz(const std::filesystem::path& path, const ReportInput& input, const Report& report,
               const ReportLayers& layers, bool overwrite);

}  // namespace pilotage
