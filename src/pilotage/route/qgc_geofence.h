#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "pilotage/route/ogr_areas.h"

namespace pilotage {

/// The geofence of a QGroundControl plan. A circle stands as a polygon of kFenceCircleCorners corners that errs on the
/// safe side: around an excluded circle, inside an included one.
struct QgcGeofence {
  std::vector<GeodeticArea> excluded;  ///< Not to be entered.
  std::vector<GeodeticArea> included;  ///< Not to be left.
  /// A point must lie in every included area (as ArduPilot wants it by default, and whatever else flies), or in any of
  /// them (PX4, by the plan's firmwareType).
  bool inside_any = false;
};

inline constexpr int kFenceCircleCorners = 72;

/// `geoFence` of a plan, of version 1 or 2: polygons of `[latitude, longitude]` and circles, each with `inclusion`.
/// A plan without one has none. Throws DataError naming what is wrong: fewer than three corners, a corner that is no
/// place, a radius that is not positive or larger than 1,000 km.
QgcGeofence parse_qgc_geofence(const std::string& name, const nlohmann::ordered_json& json);

}  // namespace pilotage
