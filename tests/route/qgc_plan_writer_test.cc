#include "pilotage/route/qgc_plan_writer.h"

#include <cmath>

#include "route/route_files.h"
#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/json_object.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/output_file.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/route/qgc_geofence.h"
#include "pilotage/route/qgc_plan.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Json simple(int number, int command, int frame, const std::vector<double>& params) {
  Json list = Json::array();
  for (const double param : params) list.push_back(json_number(param));
  return {{"autoContinue", true}, {"command", command},   {"doJumpId", number},       {"frame", frame},
          {"params", list},       {"type", "SimpleItem"}, {"ofAnotherTool", {1, 2.5}}};
}

// Takeoff, speed, three waypoints between which a camera and a speed are set, the last one, return.
Json small_plan() {
  Json items = Json::array();
  items.push_back(simple(1, 22, 3, {15, 0, 0, kNaN, 55.50, 16.480, 100}));
  items.push_back(simple(2, 178, 2, {1, 18, -1, 0, 0, 0, 0}));
  items.push_back(simple(3, 16, 3, {0, 0, 0, kNaN, 55.50, 16.485, 110}));
  items.push_back(simple(4, 206, 2, {25, 0, 1, 0, 0, 0, 0}));
  items.push_back(simple(5, 16, 3, {12, 0, 0, kNaN, 55.50, 16.490, 120}));
  items.push_back(simple(6, 178, 2, {1, 22, -1, 0, 0, 0, 0}));
  items.push_back(simple(7, 16, 3, {0, 0, 0, kNaN, 55.50, 16.500, 130}));
  items.push_back(simple(8, 20, 2, {0, 0, 0, 0, 0, 0, 0}));
  return {{"fileType", "Plan"},
          {"geoFence", {{"circles", Json::array()}, {"polygons", Json::array()}, {"version", 2}}},
          {"groundStation", "QGroundControl"},
          {"mission",
           {{"cruiseSpeed", 18},
            {"firmwareType", 12},
            {"hoverSpeed", 5},
            {"items", items},
            {"plannedHomePosition", {55.50, 16.480, 50}},
            {"vehicleType", 2},
            {"version", 2}}},
          {"rallyPoints", {{"points", {{55.5, 16.49, 20}}}, {"version", 2}}},
          {"unknownToUs", {{"stays", true}}},
          {"version", 1}};
}

PlanWaypoint waypoint(double lat_deg, double lon_deg, double amsl_m) {
  return {{lon_deg, lat_deg}, amsl_m, kNaN, 0.5};
}

TEST(QgcPlanWriter, NothingMovedIsNothingChanged) {
  for (const char* name : {"survey.plan"}) {
    const Json json = Json::parse(read_file(testing::route_file(name)));
    const Route route = parse_qgc_plan(name, json, {});
    const MovedPlan moved = move_stretches(name, json, route, {});
    EXPECT_EQ(moved.json.dump(), json.dump()) << name;
    EXPECT_THAT(moved.removed, IsEmpty());
  }
}

TEST(QgcPlanWriter, MovesAStretchAndKeepsTheRest) {
  const Json json = small_plan();
  const Route route = parse_qgc_plan("p", json, {});
  ASSERT_EQ(route.vertices.size(), 5U);
  // From the takeoff to the last waypoint.
  const MovedPlan moved =
      move_stretches("p", json, route, {{0, 3, {waypoint(55.501, 16.484, 165.004), waypoint(55.501, 16.4905, 171)}}});
  Json expected = json;
  for (const char* key : {"geoFence", "groundStation", "rallyPoints", "unknownToUs", "version"}) {
    EXPECT_EQ(moved.json[key], expected[key]) << key;
  }
  expected["mission"].erase("items");
  Json others = moved.json["mission"];
  others.erase("items");
  EXPECT_EQ(others, expected["mission"]);

  const Json& items = moved.json["mission"]["items"];
  std::vector<int> commands;
  std::vector<int> numbers;
  for (const Json& item : items) {
    commands.push_back(item["command"].get<int>());
    numbers.push_back(item["doJumpId"].get<int>());
  }
  EXPECT_THAT(commands, ElementsAre(22, 178, 16, 206, 16, 178, 16, 20));
  EXPECT_THAT(numbers, ElementsAre(1, 2, 3, 4, 5, 6, 7, 8));
  EXPECT_EQ(items[0], json["mission"]["items"][0]);
  EXPECT_EQ(items[3]["ofAnotherTool"], json["mission"]["items"][3]["ofAnotherTool"]);
  EXPECT_EQ(items[6], json["mission"]["items"][6]) << "its end stays";
  EXPECT_EQ(items[2]["frame"], 3) << "as where the stretch begins";
  EXPECT_EQ(items[2]["params"][6], 115) << "above home, to the centimetre";
  EXPECT_THAT(moved.removed, ElementsAre("item 3 (waypoint)", "item 5 (waypoint)"));
  EXPECT_THAT(moved.lost, ElementsAre("item 5 (waypoint) had to go: its hold of 12 s is not done"));
  ASSERT_EQ(moved.shifted.size(), 2U);
  EXPECT_THAT(moved.shifted[0], HasSubstr("item 4 (camera trigger distance) now happens at waypoint 1 of its stretch"));
  EXPECT_THAT(moved.shifted[1], HasSubstr("item 6 (change speed) now happens at waypoint 2 of its stretch"));

  const Route again = parse_qgc_plan("p", moved.json, {});
  ASSERT_EQ(again.vertices.size(), 5U);
  EXPECT_EQ(again.vertices[1].point.lat_deg, 55.501);
  EXPECT_EQ(again.vertices[1].point.lon_deg, 16.484);
  EXPECT_EQ(again.vertices[1].amsl_m, 165);
  EXPECT_EQ(again.vertices[2].amsl_m, 171);
  EXPECT_EQ(again.vertices[3].speed_mps, 22) << "the change of speed still comes before the last waypoint";
  EXPECT_EQ(again.vertices[4].kind, "return");
}

TEST(QgcPlanWriter, NumbersBehindAStretchMoveWithIt) {
  const Json json = small_plan();
  const Route route = parse_qgc_plan("p", json, {});
  const MovedPlan more = move_stretches(
      "p", json, route,
      {{1, 2, {waypoint(55.501, 16.486, 160), waypoint(55.502, 16.487, 160), waypoint(55.501, 16.488, 160)}}});
  const MovedPlan fewer = move_stretches("p", json, route, {{0, 3, {}}});
  EXPECT_EQ(more.json["mission"]["items"].back()["doJumpId"], 11);
  EXPECT_EQ(fewer.json["mission"]["items"].back()["doJumpId"], 6);
  EXPECT_THAT(more.removed, IsEmpty());
  EXPECT_EQ(parse_qgc_plan("p", more.json, {}).vertices.size(), 8U);
  EXPECT_EQ(parse_qgc_plan("p", fewer.json, {}).vertices.size(), 3U);
}

TEST(QgcPlanWriter, HeightsGoIntoTheFrameOfTheStretch) {
  Json json = small_plan();
  for (const auto& [frame, amsl_m, agl_m, expected] :
       {std::tuple(0, 165.0, kNaN, 165.0), std::tuple(3, 165.0, kNaN, 115.0), std::tuple(10, kNaN, 80.0, 80.0),
        // What neither the frame nor the route tells is between the heights of both ends in the file.
        std::tuple(10, kNaN, kNaN, 115.0)}) {
    for (Json& item : json["mission"]["items"]) {
      if (item["command"] == 16 || item["command"] == 22) item["frame"] = frame;
    }
    const Route route = parse_qgc_plan("p", json, {});
    const MovedPlan moved = move_stretches("p", json, route, {{1, 2, {{{16.487, 55.501}, amsl_m, agl_m, 0.5}}}});
    EXPECT_EQ(moved.json["mission"]["items"][4]["params"][6], expected) << frame;
    EXPECT_EQ(moved.json["mission"]["items"][4]["frame"], frame);
  }
}

TEST(QgcPlanWriter, RefusesJumps) {
  Json json = small_plan();
  json["mission"]["items"].push_back(simple(9, 177, 2, {3, 2, 0, 0, 0, 0, 0}));
  const std::string error =
      testing::error_of<DataError>([&] { move_stretches("p", json, parse_qgc_plan("p", json, {}), {}); });
  EXPECT_THAT(error, HasSubstr("item 9 (jump) jumps to another item"));
}

// Whatever file a route came from, the plan made of it is the same line at the same heights and speeds.
TEST(QgcPlanWriter, ARouteBecomesAPlanThatReadsBack) {
  Route route;
  route.name = "r";
  const auto add = [&](double lon_deg, double amsl_m, double agl_m, double speed_mps) {
    RouteVertex vertex;
    vertex.point = {lon_deg, 55.123456789012};
    vertex.amsl_m = amsl_m;
    vertex.agl_m = agl_m;
    vertex.speed_mps = speed_mps;
    route.vertices.push_back(vertex);
    const auto last = static_cast<int>(route.vertices.size()) - 1;
    if (last == 0) return;
    const auto from = static_cast<std::size_t>(last) - 1;
    route.legs.push_back(
        {last - 1, last, geodesic_between(route.vertices[from].point, route.vertices.back().point).length_m});
  };
  add(16.1000000000001, 120, kNaN, 15);
  add(16.11, 140.25, kNaN, 15);
  add(16.12, kNaN, 90, 21);
  add(16.13, kNaN, 95.5, 12.5);
  const Route again = parse_qgc_plan("r", plan_of_route(route), {});
  ASSERT_EQ(again.vertices.size(), route.vertices.size());
  for (std::size_t i = 0; i < route.vertices.size(); ++i) {
    EXPECT_EQ(again.vertices[i].point.lon_deg, route.vertices[i].point.lon_deg);
    EXPECT_EQ(again.vertices[i].point.lat_deg, route.vertices[i].point.lat_deg);
    EXPECT_EQ(json_number(again.vertices[i].amsl_m), json_number(route.vertices[i].amsl_m));
    EXPECT_EQ(json_number(again.vertices[i].agl_m), json_number(route.vertices[i].agl_m));
    if (i == 0) continue;
    EXPECT_EQ(again.vertices[i].speed_mps, route.vertices[i].speed_mps);
  }
  EXPECT_EQ(route_length_m(again), route_length_m(route));
  route.legs[1].from = 0;
  EXPECT_THAT(testing::error_of<DataError>([&] { plan_of_route(route); }),
              HasSubstr("leg 2 does not begin where leg 1"));
}

TEST(QgcGeofence, ReadsPolygonsAndCirclesOnTheSafeSide) {
  Json json = small_plan();
  json["geoFence"]["polygons"] = {
      {{"inclusion", true}, {"polygon", {{55.4, 16.4}, {55.6, 16.4}, {55.6, 16.6}}}, {"version", 1}}};
  const auto circle = [](bool inclusion) {
    return Json{{"circle", {{"center", {55.5, 16.5}}, {"radius", 300}}}, {"inclusion", inclusion}, {"version", 1}};
  };
  json["geoFence"]["circles"] = {circle(true), circle(false)};
  const QgcGeofence fence = parse_qgc_geofence("p", json);
  ASSERT_EQ(fence.included.size(), 2U);
  ASSERT_EQ(fence.excluded.size(), 1U);
  EXPECT_TRUE(fence.inside_any) << "PX4";
  EXPECT_EQ(fence.included[0].rings[0][1].lat_deg, 55.6);
  EXPECT_EQ(fence.included[0].rings[0][1].lon_deg, 16.4);
  const GeodeticPoint center{16.5, 55.5};
  // Corners of the one on the circle; the middle of each edge of the other on it.
  for (const GeodeticPoint corner : fence.included[1].rings[0]) {
    EXPECT_NEAR(geodesic_between(center, corner).length_m, 300, 1e-6);
  }
  const auto& around = fence.excluded[0].rings[0];
  for (std::size_t i = 0; i < around.size(); ++i) {
    const GeodeticPoint& next = around[(i + 1) % around.size()];
    const GeodeticPoint middle{(around[i].lon_deg + next.lon_deg) / 2, (around[i].lat_deg + next.lat_deg) / 2};
    EXPECT_NEAR(geodesic_between(center, middle).length_m, 300, 1e-3);
  }
  json["mission"]["firmwareType"] = 3;
  EXPECT_FALSE(parse_qgc_geofence("p", json).inside_any) << "ArduPilot";
  json["geoFence"]["circles"][0]["circle"]["radius"] = 0;
  EXPECT_THAT(testing::error_of<DataError>([&] { parse_qgc_geofence("p", json); }), HasSubstr("radius = 0 is outside"));
  json["geoFence"] = {{"circles", Json::array()}, {"polygons", {{{"inclusion", false}, {"polygon", {{1, 2}}}}}}};
  EXPECT_THAT(testing::error_of<DataError>([&] { parse_qgc_geofence("p", json); }),
              HasSubstr("fewer than three corners"));
}

}  // namespace
}  // namespace pilotage
