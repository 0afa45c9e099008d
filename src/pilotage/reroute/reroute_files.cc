#include "pilotage/reroute/reroute_files.h"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "pilotage/base/json_object.h"
#include "pilotage/base/wording.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;

double to_decimals(double value, int decimals) {
  const double steps = std::pow(10, decimals);
  return std::round(value * steps) / steps;
}

Json line_json(const RerouteLine& line) {
  Json json = {{"verdict", std::string(verdict_name(line.verdict))},
               {"verdict_text", line.verdict_text},
               {"p_within_limit", line.p_within_limit ? json_number(*line.p_within_limit) : Json(nullptr)},
               {"largest_error_m", json_number(to_decimals(line.largest_error_m, 2))},
               {"matchable_fraction", to_decimals(line.matchable_fraction, 4)},
               {"length_m", to_decimals(line.length_m, 2)},
               {"duration_s", to_decimals(line.duration_s, 2)},
               {"turns", line.turns},
               {"turned_deg", to_decimals(line.turned_deg, 1)},
               {"no_fly_m", to_decimals(line.no_fly_m, 2)},
               {"points", Json::array()}};
  for (const GeodeticPoint& point : line.points) {
    json["points"].push_back({to_decimals(point.lon_deg, 7), to_decimals(point.lat_deg, 7)});
  }
  return json;
}

Json line_feature(const char* role, const RerouteLine& line) {
  Json coordinates = line_json(line)["points"];
  return {{"type", "Feature"},
          {"properties",
           {{"line", role},
            {"verdict", std::string(verdict_name(line.verdict))},
            {"p_within_limit", line.p_within_limit ? json_number(*line.p_within_limit) : Json(nullptr)},
            {"length_m", to_decimals(line.length_m, 2)},
            {"stroke", std::string(role) == "planned" ? "#777777" : "#000000"}}},
          {"geometry", {{"type", "LineString"}, {"coordinates", std::move(coordinates)}}}};
}

Json ring_feature(const char* role, const std::vector<GeodeticPoint>& ring) {
  Json corners = Json::array();
  for (const GeodeticPoint& corner : ring) {
    corners.push_back({to_decimals(corner.lon_deg, 7), to_decimals(corner.lat_deg, 7)});
  }
  corners.push_back(corners.front());
  return {{"type", "Feature"},
          {"properties", {{"zone", role}}},
          {"geometry", {{"type", "LineString"}, {"coordinates", std::move(corners)}}}};
}

}  // namespace

std::string cost_text(const RerouteResult& result) {
  const RerouteLine& before = result.before;
  const RerouteLine& after = result.after;
  return signed_text((after.length_m - before.length_m) / 1000, 2) + " km, " +
         signed_text((after.duration_s - before.duration_s) / 60, 1) + " min, " +
         signed_text(after.turns - before.turns, 0) + " turns (" +
         signed_text(after.turned_deg - before.turned_deg, 0) + "°)";
}

Json reroute_to_json(const RerouteResult& result) {
  Json json = {
      {"pilotage_reroute", 1},
      {"found_go", result.found_go},
      {"assumptions", result.assumptions},
      {"planned", line_json(result.before)},
      {"new", line_json(result.after)},
      {"extra",
       {{"length_m", to_decimals(result.after.length_m - result.before.length_m, 2)},
        {"duration_s", to_decimals(result.after.duration_s - result.before.duration_s, 2)},
        {"turns", result.after.turns - result.before.turns},
        {"turned_deg", to_decimals(result.after.turned_deg - result.before.turned_deg, 1)}}},
      {"moved_legs", Json::array()},
      {"search",
       {{"within_m", to_decimals(result.search_within_m, 1)},
        {"tiles", result.tiles},
        {"lines_tried", result.lines_tried},
        {"lines_verified", result.lines_verified}}},
      {"items", {{"removed", result.removed_items}, {"lost", result.lost_items}, {"shifted", result.shifted_items}}},
      {"notes", result.notes}};
  for (const int leg : result.moved_legs) json["moved_legs"].push_back(leg + 1);
  return json;
}

Json reroute_to_geojson(const RerouteResult& result) {
  Json features = Json::array({line_feature("planned", result.before), line_feature("new", result.after)});
  for (const auto& ring : result.no_fly_rings) features.push_back(ring_feature("no-fly", ring));
  for (const auto& ring : result.fence_rings) features.push_back(ring_feature("fence", ring));
  return {{"type", "FeatureCollection"}, {"features", std::move(features)}};
}

}  // namespace pilotage
