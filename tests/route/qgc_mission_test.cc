#include "pilotage/route/qgc_mission.h"

#include <string>

#include "route/route_files.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::route_error;

std::string mission_item(int id, int command, const std::string& coordinate, int frame) {
  return R"({"autoContinue": true, "command": )" + std::to_string(command) + R"(, "coordinate": )" + coordinate +
         R"(, "frame": )" + std::to_string(frame) + R"(, "id": )" + std::to_string(id) +
         R"(, "param1": 0, "param2": 0, "param3": 0, "param4": 0, "type": "missionItem"})";
}

std::string old_mission(const std::string& version, const std::string& complex_items) {
  return R"({"MAV_AUTOPILOT": 3, "complexItems": [)" + complex_items + R"(], "items": [)" +
         mission_item(1, 22, "[47, 8, 50]", 3) + "," + mission_item(2, 16, "[47.01, 8, 60]", 3) +
         R"(], "plannedHomePosition": )" + mission_item(0, 16, "[47, 8, 400]", 0) + R"(, "version": )" + version + "}";
}

TEST(QgcMission, ReadsVersionOne) {
  const Route route = parse_route("r", old_mission("\"1.0\"", ""));
  EXPECT_EQ(route.format, "QGroundControl mission 1.0");
  ASSERT_EQ(route.vertices.size(), 2U);
  EXPECT_EQ(route.vertices[0].kind, "takeoff");
  EXPECT_EQ(route.vertices[1].amsl_m, 460);
  EXPECT_EQ(route.vertices[1].source_item, 2);
}

TEST(QgcMission, OthersAreRefusedByName) {
  EXPECT_THAT(route_error(old_mission("2", "")),
              HasSubstr("of version 2, and \"1.0\" is read; open it in QGroundControl"));
  EXPECT_THAT(route_error(old_mission("\"1.0\"", "{}")), HasSubstr("holds complex items (surveys)"));
  EXPECT_THAT(route_error("#saved by Mission Planner 1.3.80\n47 8\n47.1 8\n"), HasSubstr("an area and no path"));
}

}  // namespace
}  // namespace pilotage
