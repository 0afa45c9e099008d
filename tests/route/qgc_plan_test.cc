#include "pilotage/route/qgc_plan.h"

#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include "route/route_files.h"
#include "testing/replaced.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::replaced;
using testing::route_error;
using testing::route_file;
using testing::route_file_error;

TEST(QgcPlan, ReadsSurveyCorridorAndLanding) {
  const Route route = read_route(route_file("survey.plan"));
  // takeoff, waypoint, 3 survey, 2 corridor, waypoint, approach, land
  ASSERT_EQ(route.vertices.size(), 10U);
  EXPECT_EQ(route.vertices[0].kind, "takeoff");
  EXPECT_EQ(route.vertices[0].amsl_m, 480);
  EXPECT_EQ(route.vertices[2].kind, "survey");
  std::vector<int> numbers;
  for (const RouteVertex& vertex : route.vertices) numbers.push_back(vertex.source_item);
  EXPECT_THAT(numbers, ElementsAre(1, 2, 3, 3, 3, 8, 8, 11, 12, 12))
      << "as QGroundControl shows them: a survey of five "
         "commands is 3, what follows it 8";
  EXPECT_EQ(route.vertices[5].kind, "corridor scan");
  EXPECT_EQ(route.vertices[6].speed_mps, 20);
  EXPECT_EQ(route.vertices[7].speed_mps, 25) << "after the change of speed";
  EXPECT_EQ(route.vertices[8].kind, "fixed-wing landing");
  EXPECT_EQ(route.vertices[8].amsl_m, 440);
  EXPECT_FALSE(route.vertices[8].on_ground);
  EXPECT_TRUE(route.vertices[9].on_ground);
  EXPECT_EQ(route.legs.size(), 9U);
  ASSERT_TRUE(route.camera);
  EXPECT_EQ(route.camera->name, "Test 24");
  EXPECT_EQ(route.camera->image_width_px, 6000);
  EXPECT_EQ(route.camera->focal_length_mm, 16);
  ASSERT_EQ(route.items.size(), 8U);
  EXPECT_EQ(route.items[2].what, "survey");
  EXPECT_THAT(route.items[2].became, HasSubstr("3 vertices from its 5 mission items"));
  EXPECT_EQ(route.items[4].what, "structure scan");
  EXPECT_THAT(route.notes, Contains(HasSubstr("structure scan")));
}

TEST(QgcPlan, LoopsHoldEachLegOnce) {
  const Route route = read_route(route_file("loop.plan"));
  ASSERT_EQ(route.vertices.size(), 6U);
  std::set<std::pair<int, int>> legs;
  for (const RouteLeg& leg : route.legs) EXPECT_TRUE(legs.emplace(leg.from, leg.to).second);
  EXPECT_EQ(legs, (std::set<std::pair<int, int>>{{0, 1}, {1, 2}, {2, 3}, {3, 1}, {3, 4}, {4, 5}}));
  EXPECT_EQ(route.vertices[5].kind, "return");
  EXPECT_THAT(route.notes, Contains(HasSubstr("The mission loops")));
}

TEST(QgcPlan, JumpsWithoutEndHideWhatFollows) {
  const std::string text = read_file(route_file("loop.plan"));
  // doJumpId 5 jumps to 2 forever.
  const Route route =
      parse_route("r", replaced(text, "2,\n     3,\n     0,\n     0,", "2,\n     -1,\n     0,\n     0,"));
  EXPECT_EQ(route.vertices.size(), 4U);
  EXPECT_EQ(route.legs.size(), 4U);
  EXPECT_THAT(route.items.back().became, HasSubstr("not reached"));
  EXPECT_THAT(route_error(replaced(text, "2,\n     3,\n     0,\n     0,", "99,\n     3,\n     0,\n     0,")),
              HasSubstr("jumps to item 99, which does not exist"));
}

TEST(QgcPlan, TerrainFramesAreAboveGround) {
  const Route route = read_route(route_file("terrain.plan"));
  EXPECT_EQ(route.vertices[0].agl_m, 120);
  EXPECT_EQ(route.vertices[1].agl_m, 180);
  EXPECT_TRUE(std::isnan(route.vertices[0].amsl_m));
}

TEST(QgcPlan, OptionsOverrideHeightAndSpeed) {
  RouteOptions options;
  options.agl_m = 90;
  options.speed_mps = 12;
  const Route route = read_route(route_file("no_home.plan"), options);
  for (const RouteVertex& vertex : route.vertices) {
    EXPECT_EQ(vertex.agl_m, 90);
    EXPECT_TRUE(std::isnan(vertex.amsl_m));
    EXPECT_EQ(vertex.speed_mps, 12);
  }
  options.agl_m = 0;
  EXPECT_THAT(route_file_error(route_file("no_home.plan"), options), HasSubstr("agl_m = 0 is outside"));
}

TEST(QgcPlan, TakeoffAwayFromHomeStartsAtHome) {
  const std::string text = read_file(route_file("loop.plan"));
  const Route route = parse_route("r", replaced(text, "47.0,\n   8.0,\n   400", "46.98,\n   8.0,\n   400"));
  EXPECT_EQ(route.vertices[0].kind, "home");
  EXPECT_EQ(route.vertices[0].point.lat_deg, 46.98);
  EXPECT_EQ(route.vertices[0].amsl_m, 480) << "climbs over home";
  EXPECT_EQ(route.vertices[1].kind, "takeoff");
}

TEST(QgcPlan, ErrorsNameTheItem) {
  EXPECT_THAT(route_file_error(route_file("no_home.plan")),
              HasSubstr("item 1 (waypoint): its altitude 120 m is relative"));
  EXPECT_THAT(route_file_error(route_file("null_position.plan")), HasSubstr("item 1 (waypoint): has no latitude"));
  EXPECT_THAT(route_file_error(route_file("local_frame.plan")), HasSubstr("coordinate frame 1 is not supported"));
  EXPECT_THAT(route_file_error(route_file("no_position.plan")), HasSubstr("has no position to fly to"));

  const std::string text = read_file(route_file("survey.plan"));
  EXPECT_THAT(route_error(replaced(text, "\"Plan\"", "\"Params\"")), HasSubstr("fileType = \"Params\""));
  EXPECT_THAT(route_error(replaced(text, "\"fileType\": \"Plan\",", "")), HasSubstr("fileType is missing"));
  EXPECT_THAT(route_error(replaced(text, "\"survey\"", "\"spiral\"")), HasSubstr("\"spiral\" is not supported"));
  EXPECT_THAT(route_error(replaced(text, "\"version\": 5", "\"version\": 9")),
              HasSubstr("version = 9 is not supported"));
  EXPECT_THAT(route_error(replaced(text, "\"command\": 22", "\"command\": 22.5")), HasSubstr("expected an integer"));
  EXPECT_THAT(route_error(replaced(text, "\"command\": 22", "\"command\": \"22\"")), HasSubstr("expected an integer"));
  EXPECT_EQ(route_error(replaced(text, "\"command\": 22", "\"command\": 22.0")), "") << "a whole number";
  EXPECT_EQ(route_error(replaced(text, "\"command\": 22", "\"note\": \"x\", \"command\": 22")), "")
      << "QGroundControl's own keys are not all known";
  EXPECT_THAT(route_error(replaced(text, "47.01,", "97.01,")), HasSubstr("latitude 97.01 is outside [-90, 90]"));
  EXPECT_THAT(route_error(replaced(text, "\"Items\"", "\"Atoms\"")), HasSubstr(".Items is missing"));
  EXPECT_THAT(route_error(replaced(text, "47.0,", "1e999,")), HasSubstr("not valid JSON"));
}

TEST(QgcPlan, VersionsAreHeld) {
  std::string text = read_file(route_file("loop.plan"));
  EXPECT_EQ(route_error(text), "");
  const auto plan_version = text.rfind("\"version\": 1");
  EXPECT_THAT(route_error(std::string(text).replace(plan_version, 12, "\"version\": 2")),
              HasSubstr("r.version = 2 is not supported; allowed: 1"));
  const auto mission_end = text.find("\"plannedHomePosition\"");
  const auto mission_version = text.rfind("\"version\": 2", mission_end);
  EXPECT_THAT(route_error(std::string(text).replace(mission_version, 12, "\"version\": 3")),
              HasSubstr("r.mission.version = 3 is not supported; allowed: 2"));
}

TEST(QgcPlan, VectorOptionsAreRefused) {
  RouteOptions options;
  options.height_reference = HeightReference::kAgl;
  EXPECT_THAT(route_file_error(route_file("loop.plan"), options), HasSubstr("height_reference is for KML"));
}

}  // namespace
}  // namespace pilotage
