#include "pilotage/route/route_json.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string_view>

#include "pilotage/base/error.h"
#include "pilotage/route/json_view.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

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

void require_keys(const JsonView& object, std::initializer_list<std::string_view> allowed) {
  object.require_object();
  for (const auto& [key, value] : object.json().items()) {
    if (std::find(allowed.begin(), allowed.end(), key) == allowed.end()) {
      throw DataError(object.where() + ": unknown key \"" + key + "\"");
    }
  }
}

double number_or_unknown(const JsonView& object, const char* key) {
  const auto value = object.find(key);
  return value ? value->number() : kUnknown;
}

GeodeticPoint point_of(const JsonView& object) {
  return checked_point(object.at("lat_deg").number(), object.at("lon_deg").number(), object.where());
}

RouteVertex vertex_from_json(const JsonView& json) {
  require_keys(json, {"lon_deg", "lat_deg", "amsl_m", "agl_m", "speed_mps", "source_item", "kind", "on_ground"});
  RouteVertex vertex;
  vertex.point = point_of(json);
  vertex.amsl_m = checked_height_m(number_or_unknown(json, "amsl_m"), json.where());
  vertex.agl_m = checked_height_m(number_or_unknown(json, "agl_m"), json.where());
  vertex.speed_mps = number_or_unknown(json, "speed_mps");
  if (vertex.speed_mps <= 0) json.at("speed_mps").fail("a speed above 0");
  vertex.source_item = json.at("source_item").integer();
  vertex.kind = json.at("kind").text();
  vertex.on_ground = json.at("on_ground").boolean();
  return vertex;
}

RouteLeg leg_from_json(const JsonView& json, std::size_t vertex_count) {
  require_keys(json, {"from", "to", "length_m"});
  RouteLeg leg{json.at("from").integer(), json.at("to").integer(), json.at("length_m").number()};
  for (const char* key : {"from", "to"}) {
    const int index = json.at(key).integer();
    if (index < 0 || static_cast<std::size_t>(index) >= vertex_count) {
      json.at(key).fail("the index of one of " + std::to_string(vertex_count) + " vertices");
    }
  }
  if (!(leg.length_m > 0)) json.at("length_m").fail("a length above 0");
  return leg;
}

RouteCamera camera_from_json(const JsonView& json) {
  require_keys(json,
               {"name", "sensor_width_mm", "sensor_height_mm", "focal_length_mm", "image_width_px", "image_height_px"});
  RouteCamera camera;
  camera.name = json.at("name").text();
  camera.sensor_width_mm = json.at("sensor_width_mm").number();
  camera.sensor_height_mm = json.at("sensor_height_mm").number();
  camera.focal_length_mm = json.at("focal_length_mm").number();
  camera.image_width_px = json.at("image_width_px").integer();
  camera.image_height_px = json.at("image_height_px").integer();
  if (!(camera.sensor_width_mm > 0 && camera.sensor_height_mm > 0 && camera.focal_length_mm > 0 &&
        camera.image_width_px > 0 && camera.image_height_px > 0)) {
    json.fail("figures above 0");
  }
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
  const JsonView view(json, name);
  require_keys(view, {"name", "format", "length_m", "home", "camera", "vertices", "legs", "items", "notes"});
  Route route;
  route.name = view.at("name").text();
  route.format = view.at("format").text();
  if (const auto home = view.find("home")) {
    require_keys(*home, {"lon_deg", "lat_deg", "amsl_m"});
    route.home = RouteHome{point_of(*home), checked_height_m(number_or_unknown(*home, "amsl_m"), home->where())};
  }
  if (const auto camera = view.find("camera")) route.camera = camera_from_json(*camera);
  const JsonView vertices = view.at("vertices");
  for (std::size_t i = 0; i < vertices.size(); ++i) route.vertices.push_back(vertex_from_json(vertices.at(i)));
  const JsonView legs = view.at("legs");
  for (std::size_t i = 0; i < legs.size(); ++i) {
    route.legs.push_back(leg_from_json(legs.at(i), route.vertices.size()));
  }
  const JsonView items = view.at("items");
  for (std::size_t i = 0; i < items.size(); ++i) {
    const JsonView item = items.at(i);
    require_keys(item, {"index", "command", "what", "became"});
    route.items.push_back(
        {item.at("index").integer(), item.at("command").integer(), item.at("what").text(), item.at("became").text()});
  }
  const JsonView notes = view.at("notes");
  for (std::size_t i = 0; i < notes.size(); ++i) route.notes.push_back(notes.at(i).text());
  const double length_m = view.at("length_m").number();
  if (std::abs(length_m - route_length_m(route)) > 1e-6 * std::max(1.0, length_m)) {
    view.at("length_m").fail("the sum of the legs, " + std::to_string(route_length_m(route)));
  }
  return route;
}

}  // namespace pilotage
