#include "pilotage/route/qgc_geofence.h"

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/route/mission_command.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

constexpr double kLargestFence_m = 1e6;

GeodeticArea fence_polygon(JsonObject& json) {
  GeodeticArea area;
  auto& ring = area.rings.emplace_back();
  for (const auto& corner : json.list("polygon")) {
    const bool is_place = corner.is_array() && corner.size() >= 2 && corner[0].is_number() && corner[1].is_number();
    if (!is_place) json.fail("polygon", "corners of latitude and longitude");
    ring.push_back(checked_point(corner[0].get<double>(), corner[1].get<double>(), json.path("polygon")));
  }
  if (ring.size() < 3) throw DataError(json.path("polygon") + ": has fewer than three corners");
  return area;
}

GeodeticArea fence_circle(JsonObject& json, bool inclusion) {
  JsonObject circle = json.object("circle");
  const std::vector<double> center = circle.numbers("center", 2);
  const GeodeticPoint middle = checked_point(center[0], center[1], circle.path("center"));
  const double radius_m = circle.number("radius");
  if (!(radius_m > 0 && radius_m <= kLargestFence_m)) {
    throw DataError(circle.path("radius") + " = " + format_number(radius_m) + " is outside (0, " +
                    format_number(kLargestFence_m) + "]");
  }
  const double half_step_rad = std::numbers::pi / kFenceCircleCorners;
  const double reach_m = inclusion ? radius_m : radius_m / std::cos(half_step_rad);
  GeodeticArea area;
  auto& ring = area.rings.emplace_back();
  for (int i = 0; i < kFenceCircleCorners; ++i) {
    ring.push_back(geodesic_direct(middle, 360.0 * i / kFenceCircleCorners, reach_m));
  }
  return area;
}

}  // namespace

QgcGeofence parse_qgc_geofence(const std::string& name, const nlohmann::ordered_json& json) {
  QgcGeofence fence;
  JsonObject plan(json, name);
  if (!plan.has_value("geoFence")) return fence;
  JsonObject areas = plan.object("geoFence");
  const auto add = [&](const char* key, auto shape) {
    if (!areas.has_value(key)) return;
    for (JsonObject& one : areas.objects(key)) {
      const bool inclusion = one.boolean("inclusion");
      (inclusion ? fence.included : fence.excluded).push_back(shape(one, inclusion));
    }
  };
  add("polygons", [](JsonObject& one, bool) { return fence_polygon(one); });
  add("circles", [](JsonObject& one, bool inclusion) { return fence_circle(one, inclusion); });
  if (plan.has_value("mission")) {
    JsonObject mission = plan.object("mission");
    fence.inside_any = mission.has_value("firmwareType") && mission.small_integer("firmwareType") == kPx4Autopilot;
  }
  return fence;
}

}  // namespace pilotage
