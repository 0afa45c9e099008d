#include "pilotage/route/route_json.h"

#include "route/route_files.h"
#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/route/describe_route.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::route_file;
using Json = nlohmann::ordered_json;

std::string json_error(const Json& json) {
  return testing::error_of<DataError>([&] { route_from_json(json, "plan.json: route"); });
}

TEST(RouteJson, ReadsBackExactly) {
  for (const char* name : {"survey.plan", "loop.plan", "terrain.plan", "mission.waypoints", "antimeridian.geojson"}) {
    const Json json = route_to_json(read_route(route_file(name)));
    const Json again = route_to_json(route_from_json(Json::parse(json.dump()), name));
    EXPECT_EQ(json.dump(), again.dump()) << name;
  }
}

TEST(RouteJson, IsStrict) {
  const Json good = route_to_json(read_route(route_file("loop.plan")));
  EXPECT_EQ(json_error(good), "");
  const auto broken = [&](const char* pointer, const Json& value) {
    Json json = good;
    json[Json::json_pointer(pointer)] = value;
    return json_error(json);
  };
  EXPECT_THAT(broken("/extra", 1), HasSubstr(".extra is not known"));
  EXPECT_THAT(broken("/legs/0/to", 99), HasSubstr("legs[0].to = 99 is outside [0, 5]"));
  EXPECT_THAT(broken("/legs/0/to", -1), HasSubstr("legs[0].to = -1"));
  EXPECT_THAT(broken("/legs/0/to", 1.5), HasSubstr("expected an integer"));
  EXPECT_THAT(broken("/legs/0/length_m", -3), HasSubstr("legs[0].length_m is -3, expected a number above 0"));
  EXPECT_THAT(broken("/length_m", 1), HasSubstr("the sum of the legs"));
  EXPECT_THAT(broken("/vertices/0/lat_deg", 91), HasSubstr("latitude 91"));
  EXPECT_THAT(broken("/vertices/0/kind", 7), HasSubstr("vertices[0].kind is 7, expected a string"));
  EXPECT_THAT(broken("/vertices", "none"), HasSubstr("expected a list"));
  EXPECT_THAT(broken("/vertices/0/surplus", 1), HasSubstr("vertices[0].surplus is not known"));
  EXPECT_THAT(broken("/vertices/0/speed_mps", 0), HasSubstr("vertices[0].speed_mps is 0, expected a number above 0"));
  EXPECT_THAT(json_error(Json::array()), HasSubstr("expected an object"));
  Json missing = good;
  missing.erase("items");
  EXPECT_THAT(json_error(missing), HasSubstr(".items is missing"));
}

TEST(DescribeRoute, SaysEverything) {
  const std::string text = describe_route_text(read_route(route_file("survey.plan")));
  for (const char* expected :
       {"survey.plan: QGroundControl plan", "10 vertices, 9 legs", "duration ", "home lat 47.0000000", "\"Test 24\"",
        "structure scan: left out", "speed 20.0 to 25.0 m/s", "notes:"}) {
    EXPECT_THAT(text, HasSubstr(expected));
  }
  EXPECT_THAT(text, HasSubstr("legs:\n      1  1 to 2, ")) << "vertices and legs count from 1";
  EXPECT_THAT(text, HasSubstr("\n      1  takeoff: vertex\n")) << "items have QGroundControl's numbers";
}

TEST(DescribeRoute, CutsLongLists) {
  const Route route = read_route(route_file("survey.plan"));
  const std::string text = describe_route_text(route, 4);
  EXPECT_THAT(text, HasSubstr("… 6 more …"));
}

}  // namespace
}  // namespace pilotage
