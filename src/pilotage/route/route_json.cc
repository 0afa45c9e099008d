#include "pilotage/route/route_json.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

void set_if_known(Json& json, const char* key, double value) {
  if (!std::isnan(value)) json[key] = value;
}

Json vertex_to_json(const RouteVertex& vertex) {
  Json json = {{"lon_deg", vertex.point.lon_deg}, {"lat_deg", vertex.point.lat_deg}};
  set_if_known(json, "amsl_m", vertex.amsl_m);
  set_if_known(json, "agl_m", vertex.agl_m);
  set_if_known(json, "speed_mps", vertex.speed_mps);
  json["source_item"] = vertex.source_item;
  json["kind"] = vertex.kind;
  json["on_ground"] = vertex.on_ground;
  return json;
}

GeodeticPoint point_of(JsonObject& object) {
  return checked_point(object.number("lat_deg"), object.number("lon_deg"), object.where());
}

double height_of(JsonObject& object, const std::string& key) {
  return checked_height_m(object.number_or_nan(key), object.path(key));
}

RouteHome home_from_json(JsonObject json) {
  const RouteHome home{point_of(json), height_of(json, "amsl_m")};
  json.finish();
  return home;
}

RouteVertex vertex_from_json(JsonObject& json) {
  RouteVertex vertex;
  vertex.point = point_of(json);
  vertex.amsl_m = height_of(json, "amsl_m");
  vertex.agl_m = height_of(json, "agl_m");
  if (json.has_value("speed_mps")) vertex.speed_mps = json.positive_number("speed_mps");
  vertex.source_item = json.small_integer("source_item");
  vertex.kind = json.text("kind");
  vertex.on_ground = json.boolean("on_ground");
  json.finish();
  return vertex;
}

RouteLeg leg_from_json(JsonObject& json, std::size_t vertex_count) {
  const int last = static_cast<int>(vertex_count) - 1;
  const RouteLeg leg{json.small_integer("from", 0, last), json.small_integer("to", 0, last),
                     json.positive_number("length_m")};
  json.finish();
  return leg;
}

RouteCamera camera_from_json(JsonObject json) {
  constexpr int kMaxSize_px = std::numeric_limits<int>::max();
  RouteCamera camera;
  camera.name = json.text("name");
  camera.sensor_width_mm = json.positive_number("sensor_width_mm");
  camera.sensor_height_mm = json.positive_number("sensor_height_mm");
  camera.focal_length_mm = json.positive_number("focal_length_mm");
  camera.image_width_px = json.small_integer("image_width_px", 1, kMaxSize_px);
  camera.image_height_px = json.small_integer("image_height_px", 1, kMaxSize_px);
  json.finish();
  return camera;
}

}  // namespace

Json route_to_json(const Route& route) {
  Json json = {{"name", route.name}, {"format", route.format}, {"length_m", route_length_m(route)}};
  if (route.home) {
    json["home"] = {{"lon_deg", route.home->point.lon_deg}, {"lat_deg", route.home->point.lat_deg}};
    set_if_known(json["home"], "amsl_m", route.home->amsl_m);
  }
  if (route.camera) {
    json["camera"] = {{"name", route.camera->name},
                      {"sensor_width_mm", route.camera->sensor_width_mm},
                      {"sensor_height_mm", route.camera->sensor_height_mm},
                      {"focal_length_mm", route.camera->focal_length_mm},
                      {"image_width_px", route.camera->image_width_px},
                      {"image_height_px", route.camera->image_height_px}};
  }
  json["vertices"] = Json::array();
  for (const RouteVertex& vertex : route.vertices) json["vertices"].push_back(vertex_to_json(vertex));
  json["legs"] = Json::array();
  for (const RouteLeg& leg : route.legs) {
    json["legs"].push_back({{"from", leg.from}, {"to", leg.to}, {"length_m", leg.length_m}});
  }
  json["items"] = Json::array();
  for (const RouteItem& item : route.items) {
    json["items"].push_back(
        {{"index", item.index}, {"command", item.command}, {"what", item.what}, {"became", item.became}});
  }
  json["notes"] = route.notes;
  return json;
}

Route route_from_json(const Json& json, const std::string& name) {
  JsonObject object(json, name);
  Route route;
  route.name = object.text("name");
  route.format = object.text("format");
  if (object.has_value("home")) route.home = home_from_json(object.object("home"));
  if (object.has_value("camera")) route.camera = camera_from_json(object.object("camera"));
  for (JsonObject& vertex : object.objects("vertices")) route.vertices.push_back(vertex_from_json(vertex));
  for (JsonObject& leg : object.objects("legs")) route.legs.push_back(leg_from_json(leg, route.vertices.size()));
  for (JsonObject& item : object.objects("items")) {
    route.items.push_back(
        {item.small_integer("index"), item.small_integer("command"), item.text("what"), item.text("became")});
    item.finish();
  }
  route.notes = object.texts("notes");
  const double length_m = object.number("length_m");
  if (std::abs(length_m - route_length_m(route)) > 1e-6 * std::max(1.0, length_m)) {
    object.fail("length_m", "the sum of the legs, " + std::to_string(route_length_m(route)));
  }
  object.finish();
  return route;
}

}  // namespace pilotage
