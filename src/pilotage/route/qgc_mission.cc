#include "pilotage/route/qgc_mission.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/route/mission_items.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

constexpr const char* kSaveAsPlan = "; open it in QGroundControl and save it as .plan";

MissionItem old_item(JsonObject& json) {
  MissionItem item;
  item.index = item.sequence = json.small_integer("id", 0, 1'000'000);
  item.command = json.small_integer("command");
  item.frame = json.small_integer("frame");
  for (std::size_t i = 0; i < 4; ++i) item.params[i] = json.number_or_nan("param" + std::to_string(i + 1));
  const std::vector<double> place = json.numbers_or_nan("coordinate");
  if (place.size() != 3) json.fail("coordinate", "latitude, longitude, altitude");
  std::copy(place.begin(), place.end(), item.params.begin() + 4);
  return item;
}

}  // namespace

bool is_qgc_mission(const nlohmann::ordered_json& json) {
  return json.contains("plannedHomePosition") && json.contains("items") && !json.contains("fileType") &&
         !json.contains("mission");
}

Route parse_qgc_mission(const std::string& name, const nlohmann::ordered_json& json, const RouteOptions& options) {
  JsonObject file(json, name);
  const nlohmann::ordered_json& version = file.value("version");
  if (!version.is_string() || version.get<std::string>() != "1.0") {
    throw DataError(name + ": is a .mission of an old QGroundControl of version " + version.dump().substr(0, 40) +
                    ", and \"1.0\" is read" + kSaveAsPlan);
  }
  if (file.has_value("complexItems") && !file.list("complexItems").empty()) {
    throw DataError(name + ": holds complex items (surveys), which are read from plans only" + kSaveAsPlan);
  }
  Route route;
  route.name = name;
  route.format = "QGroundControl mission 1.0";
  MavlinkMission mission;
  if (file.has_value("plannedHomePosition")) {
    JsonObject home_json = file.object("plannedHomePosition");
    const MissionItem home = old_item(home_json);
    const double lat_deg = home.params[4];
    const double lon_deg = home.params[5];
    const bool is_set = !(lat_deg == 0 && lon_deg == 0) && !(std::isnan(lat_deg) && std::isnan(lon_deg));
    if (is_set) {
      mission.home = RouteHome{checked_point(lat_deg, lon_deg, home_json.where()),
                               checked_height_m(home.params[6], home_json.where())};
    }
  }
  if (!mission.home) add_note(route, "The file names no home position (it is missing or 0, 0).");
  for (JsonObject& item : file.objects("items")) mission.items.push_back(old_item(item));
  append_mission(route, mission, options);
  apply_options(route, options);
  require_legs(route);
  return route;
}

}  // namespace pilotage
