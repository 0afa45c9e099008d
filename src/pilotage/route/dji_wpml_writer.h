#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pilotage/route/route.h"

namespace pilotage {

/// The two documents of a DJI mission.
struct DjiMission {
  std::string mission_template;  ///< wpmz/template.kml, which DJI's programs show and edit.
  std::string waylines;          ///< wpmz/waylines.wpml, which the aircraft executes.
};

/// A DJI mission (WPML 1.0.2; DJI Cloud API, API reference, DJI WPML) of a route: one wayline, a waypoint for each
/// vertex in the order of flight. parse_dji_wpml gives the same line, heights and speeds back.
///   - Heights above sea level become heights above the WGS 84 ellipsoid (EGM96), those above ground
///     realTimeFollowSurface. Which of a vertex's two is flown, route.h says.
///   - The aircraft stops at each waypoint, so that legs are as straight as the route's, and its nose follows the way.
///   - Vertices at the end that touch the ground are left out: landing is the aircraft's own (finishAction goHome).
///   - Aircraft and payload are those of `camera`, the name of a product (camera_products.h) that is a DJI aircraft's
///     own; for any other name, and for none, they are left out.
///
/// Throws DataError for a route whose legs do not follow each other, that touches the ground on its way, has no speed
/// or no heights, or heights of both kinds: a wayline has one.
DjiMission dji_mission_of(const Route& route, const std::string& camera);

/// The product that sees: the one that the options call `named`, however it is spelt there, or else that of the route
/// file; "" where neither names one. Throws as camera_product().
std::string camera_product_of(const std::string& named, const Route& route);

/// Both as a KMZ. Throws DataError as write_zip().
void write_dji_mission(const std::filesystem::path& path, const DjiMission& mission, bool overwrite);

}  // namespace pilotage
