#include "pilotage/route/ugcs_json.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/text.h"
#include "pilotage/route/corner_cut.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

constexpr double kDegPerRad = 180 / std::numbers::pi;

struct UgcsWaypoint {
  RouteVertex vertex;
  double turn_starts_m = 0;
};

double number_or(JsonObject& json, const std::string& key, double otherwise) {
  return json.has_value(key) ? json.number(key) : otherwise;
}

UgcsWaypoint ugcs_waypoint(JsonObject& segment, const std::string& file) {
  const std::string where = segment.where();
  const std::string type = segment.text("type");
  if (type != "Waypoint") {
    throw DataError(file + ": " + where + " is of type " + type.substr(0, 40) +
                    ", and waypoints are read; export the route from UgCS as KML, which holds the path of surveys too");
  }
  JsonObject point = segment.object("point");
  UgcsWaypoint waypoint;
  RouteVertex& vertex = waypoint.vertex;
  const double lat_rad = point.number("latitude");
  const double lon_rad = point.number("longitude");
  if (std::abs(lat_rad) > std::numbers::pi / 2 || std::abs(lon_rad) > std::numbers::pi) {
    throw DataError(file + ": " + where + " lies at " + format_number(lat_rad) + ", " + format_number(lon_rad) +
                    ", which are no radians, as UgCS writes them");
  }
  vertex.point = checked_point(lat_rad * kDegPerRad, lon_rad * kDegPerRad, where);
  const double height_m = checked_height_m(point.number("altitude"), where);
  const std::string height_type = point.text("altitudeType");
  if (height_type == "AGL") {
    vertex.agl_m = height_m;
  } else if (height_type == "AMSL") {
    vertex.amsl_m = height_m;
  } else {
    point.fail("altitudeType", "AGL or AMSL");
  }
  if (!segment.has_value("parameters")) return waypoint;
  JsonObject parameters = segment.object("parameters");
  const double speed_mps = number_or(parameters, "speed", kNaN);
  if (speed_mps <= 0 || speed_mps > 1000) parameters.fail("speed", "above 0 and at most 1000 m/s");
  vertex.speed_mps = speed_mps;
  const std::string turn = parameters.has_value("wpTurnType") ? parameters.text("wpTurnType") : "";
  const double radius_m = number_or(parameters, "cornerRadius", 0);
  if (turn != "STOP_AND_TURN" && turn != "STRAIGHT") waypoint.turn_starts_m = std::max(radius_m, 0.0);
  return waypoint;
}

}  // namespace

bool is_ugcs_route(const nlohmann::ordered_json& json) {
  const auto route = json.find("route");
  return route != json.end() && route->is_object() && route->contains("segments");
}

Route parse_ugcs_json(const std::string& name, const nlohmann::ordered_json& json, const RouteOptions& options) {
  JsonObject file(json, name);
  JsonObject ugcs = file.object("route");
  Route route;
  route.name = name;
  route.format = "UgCS route (JSON)";
  std::vector<UgcsWaypoint> waypoints;
  for (JsonObject& segment : ugcs.objects("segments")) {
    UgcsWaypoint waypoint = ugcs_waypoint(segment, name);
    append_waypoint(route, waypoint.vertex);
    waypoints.push_back(std::move(waypoint));
  }
  double widest_m = 0;
  for (std::size_t i = 1; i + 1 < waypoints.size(); ++i) {
    widest_m = std::max(widest_m, corner_cut_m(waypoints[i - 1].vertex.point, waypoints[i].vertex.point,
                                               waypoints[i + 1].vertex.point, waypoints[i].turn_starts_m));
  }
  add_corner_note(route, widest_m);
  const auto other_speed = [&](const UgcsWaypoint& waypoint) {
    return waypoint.vertex.speed_mps != waypoints.front().vertex.speed_mps;
  };
  if (!options.speed_mps && std::any_of(waypoints.begin(), waypoints.end(), other_speed)) {
    add_note(route, "The speeds of the waypoints differ; each is taken as that of the way to its waypoint.");
  }
  apply_options(route, options);
  require_legs(route);
  return route;
}

}  // namespace pilotage
