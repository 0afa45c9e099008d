#include "pilotage/route/qgc_plan.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/text.h"
#include "pilotage/route/mission_command.h"
#include "pilotage/route/mission_items.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

void require_version(JsonObject& object, const std::vector<int>& allowed) {
  const int version = object.small_integer("version");
  if (std::find(allowed.begin(), allowed.end(), version) != allowed.end()) return;
  std::vector<std::string> texts;
  for (const int number : allowed) texts.push_back(std::to_string(number));
  throw DataError(object.path("version") + " = " + std::to_string(version) +
                  " is not supported; allowed: " + join(texts, ", "));
}

MissionItem parse_simple_item(JsonObject& json, int index) {
  MissionItem item;
  item.index = index;
  item.command = json.small_integer("command");
  item.frame = json.small_integer("frame");
  item.sequence = json.has_value("doJumpId") ? json.small_integer("doJumpId") : -1;
  const std::vector<double> params = json.numbers_or_nan("params");
  if (params.size() != item.params.size()) json.fail("params", "7 numbers");
  std::copy(params.begin(), params.end(), item.params.begin());
  return item;
}

/// The number by which QGroundControl shows an item: its own where that goes on from the items before, else `next`.
int number_of(JsonObject& json, const MavlinkMission& mission, int next) {
  constexpr int kMost = 1'000'000;  // more than any autopilot stores
  const int last = mission.items.empty() ? 0 : mission.items.back().index;
  const int own = json.has_value("doJumpId") ? std::min(json.small_integer("doJumpId"), kMost) : 0;
  return own > last ? own : std::max(next, last + 1);
}

/// `key` is [latitude, longitude, altitude]; it becomes an item of `command`.
MissionItem parse_coordinate(JsonObject& json, const std::string& key, int index, int command, bool relative,
                             const std::string& kind) {
  if (json.list(key).size() != 3) json.fail(key, "latitude, longitude, altitude");
  MissionItem item;
  item.index = index;
  item.sequence = -1;
  item.command = command;
  item.frame = relative ? 3 : 0;
  item.kind = kind;
  std::ranges::copy(json.numbers(key, 3), item.params.begin() + 4);
  return item;
}

std::optional<RouteCamera> parse_camera(Route& route, JsonObject calc) {
  RouteCamera camera;
  camera.name = calc.has_value("CameraName") ? calc.text("CameraName") : "";
  camera.sensor_width_mm = calc.number_or_nan("SensorWidth");
  camera.sensor_height_mm = calc.number_or_nan("SensorHeight");
  camera.focal_length_mm = calc.number_or_nan("FocalLength");
  const double width_px = calc.number_or_nan("ImageWidth");
  const double height_px = calc.number_or_nan("ImageHeight");
  const bool sensible = width_px >= 1 && height_px >= 1 && width_px <= 1e6 && height_px <= 1e6 &&
                        width_px == std::floor(width_px) && height_px == std::floor(height_px) &&
                        camera.sensor_width_mm > 0 && camera.sensor_height_mm > 0 && camera.focal_length_mm > 0;
  if (!sensible) {
    add_note(route, "The plan names the camera \"" + camera.name + "\" without its figures.");
    return std::nullopt;
  }
  camera.image_width_px = static_cast<int>(width_px);
  camera.image_height_px = static_cast<int>(height_px);
  if (calc.has_value("Landscape") && !calc.boolean("Landscape")) {
    add_note(route,
             "The plan mounts the camera in portrait, the image's long side along the flight; its figures are "
             "given here for the sensor itself.");
  }
  return camera;
}

// Returns the number of its last command.
int append_transects(Route& route, MavlinkMission& mission, JsonObject& json, int number, const std::string& kind) {
  JsonObject transects = json.object("TransectStyleComplexItem");
  require_version(transects, {1, 2});
  std::vector<JsonObject> items = transects.objects("Items");
  if (items.empty()) throw DataError(transects.path("Items") + ": the " + kind + " holds no mission items");
  const int first = number_of(items.front(), mission, number);
  for (JsonObject& one : items) {
    MissionItem item = parse_simple_item(one, first);
    item.kind = kind;
    mission.items.push_back(item);
  }
  const int last = first + static_cast<int>(items.size()) - 1;
  if (!transects.has_value("CameraCalc")) return last;
  const auto camera = parse_camera(route, transects.object("CameraCalc"));
  if (!camera) return last;
  if (!route.camera) {
    route.camera = camera;
  } else if (route.camera->name != camera->name || route.camera->image_width_px != camera->image_width_px ||
             route.camera->focal_length_mm != camera->focal_length_mm) {
    add_note(route,
             "The plan names several cameras; \"" + route.camera->name + "\" is taken, not \"" + camera->name + "\".");
  }
  return last;
}

void append_landing_pattern(MavlinkMission& mission, JsonObject& json, int index, const std::string& type) {
  // Older plans hold the same under other names.
  const bool relative = json.boolean("altitudesAreRelative");
  const char* approach = json.has_value("landingApproachCoordinate") ? "landingApproachCoordinate" : "loiterCoordinate";
  const std::string kind = type == "fwLandingPattern" ? "fixed-wing landing" : "VTOL landing";
  mission.items.push_back(parse_coordinate(json, approach, index, 31, relative, kind));
  mission.items.push_back(parse_coordinate(json, "landCoordinate", index, 21, relative, kind));
}

// Returns the number of its last command; of patterns whose commands are not in the file that is its own.
int append_complex_item(Route& route, MavlinkMission& mission, JsonObject& json, int index) {
  const std::string type = json.text("complexItemType");
  if (type == "survey") {
    require_version(json, {4, 5});
    return append_transects(route, mission, json, index, "survey");
  } else if (type == "CorridorScan") {
    require_version(json, {2});
    return append_transects(route, mission, json, index, "corridor scan");
  } else if (type == "fwLandingPattern" || type == "vtolLandingPattern") {
    append_landing_pattern(mission, json, index, type);
  } else if (type == "StructureScan") {
    add_note(route,
             "Item " + std::to_string(index) +
                 " (structure scan) is left out: its path around the structure is not in the file, and its camera "
                 "does not look at the ground. The route goes straight on from the item before to the item after.");
    route.items.push_back({index, -1, "structure scan", "left out: its path is not in the file"});
  } else {
    throw DataError(json.path("complexItemType") + " = \"" + type +
                    "\" is not supported; allowed: survey, CorridorScan, StructureScan, fwLandingPattern, "
                    "vtolLandingPattern");
  }
  return index;
}

std::optional<RouteHome> parse_home(JsonObject& mission) {
  const std::string key = "plannedHomePosition";
  if (!mission.has_value(key)) return std::nullopt;
  const std::vector<double> position = mission.numbers_or_nan(key);
  if (position.size() != 2 && position.size() != 3) mission.fail(key, "latitude, longitude, altitude");
  const double lat_deg = position[0];
  const double lon_deg = position[1];
  if ((lat_deg == 0 && lon_deg == 0) || (std::isnan(lat_deg) && std::isnan(lon_deg))) return std::nullopt;
  RouteHome home{checked_point(lat_deg, lon_deg, mission.path(key))};
  if (position.size() == 3) home.amsl_m = checked_height_m(position[2], mission.path(key));
  return home;
}

bool plan_hovers(JsonObject& mission) {
  const int type = mission.has_value("vehicleType") ? mission.small_integer("vehicleType") : 1;
  // MAV_TYPE: quadrotor, coaxial, helicopter, hexarotor, octorotor, tricopter, dodecarotor, decarotor
  constexpr int kHovering[] = {2, 3, 4, 13, 14, 15, 29, 35};
  return std::find(std::begin(kHovering), std::end(kHovering), type) != std::end(kHovering);
}

/// Multicopters fly at hoverSpeed, all others (fixed wing, VTOL in transit) at cruiseSpeed.
double planned_speed_mps(JsonObject& mission, bool hovers) {
  const double speed_mps = mission.number_or_nan(hovers ? "hoverSpeed" : "cruiseSpeed");
  return speed_mps > 0 && speed_mps <= 1000 ? speed_mps : std::numeric_limits<double>::quiet_NaN();
}

void note_areas(Route& route, JsonObject& plan) {
  std::size_t count = 0;
  const auto add_areas = [&](const char* group, std::initializer_list<const char*> keys) {
    if (!plan.has_value(group)) return;
    JsonObject areas = plan.object(group);
    for (const char* key : keys) {
      if (areas.has_value(key)) count += areas.list(key).size();
    }
  };
  add_areas("geoFence", {"circles", "polygons"});
  add_areas("rallyPoints", {"points"});
  if (count > 0) add_note(route, std::to_string(count) + " geofence areas and rally points are not flown to.");
}

JsonObject open_mission(JsonObject& plan) {
  const std::string file_type = plan.text("fileType");
  if (file_type != "Plan") throw DataError(plan.path("fileType") + " = \"" + file_type + "\" is not \"Plan\"");
  require_version(plan, {1});
  JsonObject mission_json = plan.object("mission");
  require_version(mission_json, {2});
  return mission_json;
}

// Appends the items of the plan to route and mission; the number of each element of its list of items.
std::vector<int> read_items(Route& route, MavlinkMission& mission, JsonObject& mission_json) {
  std::vector<int> numbers;
  int number = 1;  // QGroundControl counts home as 0; of a survey it counts every command
  for (JsonObject& item : mission_json.objects("items")) {
    const std::string type = item.text("type");
    if (type == "SimpleItem") {
      number = number_of(item, mission, number);
      mission.items.push_back(parse_simple_item(item, number));
      numbers.push_back(number);
    } else if (type == "ComplexItem") {
      const std::size_t before = mission.items.size();
      const int last = append_complex_item(route, mission, item, number);
      numbers.push_back(mission.items.size() > before ? mission.items[before].index : number);
      number = last;
    } else {
      throw DataError(item.path("type") + " = \"" + type + "\" is neither SimpleItem nor ComplexItem");
    }
    ++number;
  }
  return numbers;
}

}  // namespace

std::vector<int> qgc_item_numbers(const std::string& name, const nlohmann::ordered_json& json) {
  JsonObject plan(json, name);
  JsonObject mission_json = open_mission(plan);
  Route route;
  MavlinkMission mission;
  return read_items(route, mission, mission_json);
}

Route parse_qgc_plan(const std::string& name, const nlohmann::ordered_json& json, const RouteOptions& options) {
  JsonObject plan(json, name);
  JsonObject mission_json = open_mission(plan);

  Route route;
  route.name = name;
  route.format = "QGroundControl plan";
  MavlinkMission mission;
  mission.home = parse_home(mission_json);
  mission.hovers = plan_hovers(mission_json);
  mission.is_px4 =
      mission_json.has_value("firmwareType") && mission_json.small_integer("firmwareType") == kPx4Autopilot;
  mission.speed_mps = planned_speed_mps(mission_json, mission.hovers);
  read_items(route, mission, mission_json);
  append_mission(route, mission, options);
  std::stable_sort(route.items.begin(), route.items.end(),
                   [](const RouteItem& a, const RouteItem& b) { return a.index < b.index; });
  note_areas(route, plan);
  if (!mission.home) add_note(route, "The plan names no home position (it is missing or 0, 0).");
  apply_options(route, options);
  require_legs(route);
  return route;
}

}  // namespace pilotage
