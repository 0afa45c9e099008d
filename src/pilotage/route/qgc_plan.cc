#include "pilotage/route/qgc_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/route/json_view.h"
#include "pilotage/route/mission_command.h"
#include "pilotage/route/mission_items.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

void require_version(const JsonView& object, const std::vector<int>& allowed) {
  const int version = object.at("version").integer();
  if (std::find(allowed.begin(), allowed.end(), version) != allowed.end()) return;
  std::vector<std::string> texts;
  for (const int number : allowed) texts.push_back(std::to_string(number));
  throw DataError(object.where() + ".version = " + std::to_string(version) +
                  " is not supported; allowed: " + join(texts, ", "));
}

MissionItem parse_simple_item(const JsonView& json, int index) {
  MissionItem item;
  item.index = index;
  item.command = json.at("command").integer();
  item.frame = json.at("frame").integer();
  const auto jump_id = json.find("doJumpId");
  item.sequence = jump_id ? jump_id->integer() : -1;
  const JsonView params = json.at("params");
  if (params.size() != item.params.size()) params.fail("7 numbers");
  for (std::size_t i = 0; i < item.params.size(); ++i) item.params[i] = params.at(i).number_or_nan();
  return item;
}

/// [latitude, longitude, altitude] as an item of `command`.
MissionItem parse_coordinate(const JsonView& json, int index, int command, bool relative, const std::string& kind) {
  if (json.size() != 3) json.fail("latitude, longitude, altitude");
  MissionItem item;
  item.index = index;
  item.sequence = -1;
  item.command = command;
  item.frame = relative ? 3 : 0;
  item.kind = kind;
  for (std::size_t i = 0; i < 3; ++i) item.params[i + 4] = json.at(i).number();
  return item;
}

std::optional<RouteCamera> parse_camera(Route& route, const JsonView& calc) {
  const auto number = [&](const char* key) {
    const auto found = calc.find(key);
    return found ? found->number() : 0;
  };
  RouteCamera camera;
  const auto name = calc.find("CameraName");
  camera.name = name ? name->text() : "";
  camera.sensor_width_mm = number("SensorWidth");
  camera.sensor_height_mm = number("SensorHeight");
  camera.focal_length_mm = number("FocalLength");
  const double width_px = number("ImageWidth");
  const double height_px = number("ImageHeight");
  const bool sensible = width_px >= 1 && height_px >= 1 && width_px <= 1e6 && height_px <= 1e6 &&
                        width_px == std::floor(width_px) && height_px == std::floor(height_px) &&
                        camera.sensor_width_mm > 0 && camera.sensor_height_mm > 0 && camera.focal_length_mm > 0;
  if (!sensible) {
    add_note(route, "The plan names the camera \"" + camera.name + "\" without its figures.");
    return std::nullopt;
  }
  camera.image_width_px = static_cast<int>(width_px);
  camera.image_height_px = static_cast<int>(height_px);
  const auto landscape = calc.find("Landscape");
  if (landscape && !landscape->boolean()) {
    add_note(route,
             "The plan mounts the camera in portrait, the image's long side along the flight; its figures are "
             "given here for the sensor itself.");
  }
  return camera;
}

void append_transects(Route& route, Mission& mission, const JsonView& json, int index, const std::string& kind) {
  const JsonView transects = json.at("TransectStyleComplexItem");
  require_version(transects, {1, 2});
  const JsonView items = transects.at("Items");
  if (items.size() == 0) throw DataError(items.where() + ": the " + kind + " holds no mission items");
  for (std::size_t i = 0; i < items.size(); ++i) {
    MissionItem item = parse_simple_item(items.at(i), index);
    item.kind = kind;
    mission.items.push_back(item);
  }
  const auto calc = transects.find("CameraCalc");
  if (!calc) return;
  const auto camera = parse_camera(route, *calc);
  if (!camera) return;
  if (!route.camera) {
    route.camera = camera;
  } else if (route.camera->name != camera->name || route.camera->image_width_px != camera->image_width_px ||
             route.camera->focal_length_mm != camera->focal_length_mm) {
    add_note(route,
             "The plan names several cameras; \"" + route.camera->name + "\" is taken, not \"" + camera->name + "\".");
  }
}

void append_landing_pattern(Mission& mission, const JsonView& json, int index, const std::string& type) {
  // Older plans hold the same under other names.
  const auto flag = json.find("altitudesAreRelative");
  if (!flag) throw DataError(json.where() + ": \"altitudesAreRelative\" is missing");
  const bool relative = flag->boolean();
  const auto approach = json.find("landingApproachCoordinate");
  const std::string kind = type == "fwLandingPattern" ? "fixed-wing landing" : "VTOL landing";
  mission.items.push_back(
      parse_coordinate(approach ? *approach : json.at("loiterCoordinate"), index, 31, relative, kind));
  mission.items.push_back(parse_coordinate(json.at("landCoordinate"), index, 21, relative, kind));
}

void append_complex_item(Route& route, Mission& mission, const JsonView& json, int index) {
  const std::string type = json.at("complexItemType").text();
  if (type == "survey") {
    require_version(json, {4, 5});
    append_transects(route, mission, json, index, "survey");
  } else if (type == "CorridorScan") {
    require_version(json, {2});
    append_transects(route, mission, json, index, "corridor scan");
  } else if (type == "fwLandingPattern" || type == "vtolLandingPattern") {
    append_landing_pattern(mission, json, index, type);
  } else if (type == "StructureScan") {
    add_note(route,
             "Item " + std::to_string(index) +
                 " (structure scan) is left out: its path around the structure is not in the file, and its camera "
                 "does not look at the ground. The route goes straight on from the item before to the item after.");
    route.items.push_back({index, -1, "structure scan", "left out: its path is not in the file"});
  } else {
    throw DataError(json.where() + ".complexItemType = \"" + type +
                    "\" is not supported; allowed: survey, CorridorScan, StructureScan, fwLandingPattern, "
                    "vtolLandingPattern");
  }
}

std::optional<RouteHome> parse_home(const JsonView& mission) {
  const auto json = mission.find("plannedHomePosition");
  if (!json) return std::nullopt;
  if (json->size() != 2 && json->size() != 3) json->fail("latitude, longitude, altitude");
  const double lat_deg = json->at(0).number_or_nan();
  const double lon_deg = json->at(1).number_or_nan();
  if ((lat_deg == 0 && lon_deg == 0) || (std::isnan(lat_deg) && std::isnan(lon_deg))) return std::nullopt;
  RouteHome home{checked_point(lat_deg, lon_deg, json->where())};
  if (json->size() == 3) home.amsl_m = checked_height_m(json->at(2).number_or_nan(), json->where());
  return home;
}

/// Multicopters fly at hoverSpeed, all others (fixed wing, VTOL in transit) at cruiseSpeed.
double planned_speed_mps(const JsonView& mission) {
  const auto vehicle = mission.find("vehicleType");
  const int type = vehicle ? vehicle->integer() : 1;
  // MAV_TYPE: quadrotor, coaxial, helicopter, hexarotor, octorotor, tricopter, dodecarotor, decarotor
  constexpr int kHovering[] = {2, 3, 4, 13, 14, 15, 29, 35};
  const bool hovers = std::find(std::begin(kHovering), std::end(kHovering), type) != std::end(kHovering);
  const auto speed = mission.find(hovers ? "hoverSpeed" : "cruiseSpeed");
  const double speed_mps = speed ? speed->number() : 0;
  return speed_mps > 0 && speed_mps <= 1000 ? speed_mps : std::numeric_limits<double>::quiet_NaN();
}

void note_areas(Route& route, const JsonView& plan) {
  std::size_t count = 0;
  if (const auto fence = plan.find("geoFence")) {
    for (const char* key : {"circles", "polygons"}) {
      const auto areas = fence->find(key);
      if (areas) count += areas->size();
    }
  }
  if (const auto rally = plan.find("rallyPoints")) {
    const auto points = rally->find("points");
    if (points) count += points->size();
  }
  if (count > 0) add_note(route, std::to_string(count) + " geofence areas and rally points are not flown to.");
}

}  // namespace

Route parse_qgc_plan(const std::string& name, const nlohmann::ordered_json& json, const RouteOptions& options) {
  const JsonView plan(json, name);
  const std::string file_type = plan.at("fileType").text();
  if (file_type != "Plan") throw DataError(name + ".fileType = \"" + file_type + "\" is not \"Plan\"");
  require_version(plan, {1});
  const JsonView mission_json = plan.at("mission");
  require_version(mission_json, {2});

  Route route;
  route.name = name;
  route.format = "QGroundControl plan";
  Mission mission;
  mission.home = parse_home(mission_json);
  mission.speed_mps = planned_speed_mps(mission_json);
  const JsonView items = mission_json.at("items");
  for (std::size_t i = 0; i < items.size(); ++i) {
    const JsonView item = items.at(i);
    const std::string type = item.at("type").text();
    const int index = static_cast<int>(i);
    if (type == "SimpleItem") {
      mission.items.push_back(parse_simple_item(item, index));
    } else if (type == "ComplexItem") {
      append_complex_item(route, mission, item, index);
    } else {
      throw DataError(item.where() + ".type = \"" + type + "\" is neither SimpleItem nor ComplexItem");
    }
  }
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
