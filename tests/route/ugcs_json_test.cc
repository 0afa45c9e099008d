#include "pilotage/route/ugcs_json.h"

#include <cmath>

#include "route/route_files.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/route/read_route.h"

// Routes of UgCS were refused with "export it as KML"; their JSON is read now.

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::route_error;

/// A waypoint at 0.82 rad north.
std::string ugcs_waypoint_text(const std::string& lon_rad, const std::string& height, const std::string& parameters) {
  return R"({"type": "Waypoint", "actions": [], "point": {"latitude": 0.82, "longitude": )" + lon_rad +
         R"(, "altitude": )" + height + R"(}, "parameters": {)" + parameters + "}}";
}

std::string ugcs_text(const std::string& segments) {
  return R"({"version": {"major": 5}, "route": {"name": "a", "segments": [)" + segments + "]}}";
}

TEST(UgcsJson, WaypointsHaveTheirPlacesHeightsAndSpeeds) {
  const std::string agl = R"(100, "altitudeType": "AGL")";
  const Route route = parse_route("r", ugcs_text(ugcs_waypoint_text("0.14", agl, R"("speed": 8)") + "," +
                                                 ugcs_waypoint_text("0.1401", agl, R"("speed": 8)") + "," +
                                                 ugcs_waypoint_text("0.1402", R"(640, "altitudeType": "AMSL")",
                                                                    R"("speed": 5, "cornerRadius": 20)")));
  EXPECT_EQ(route.format, "UgCS route (JSON)");
  ASSERT_EQ(route.vertices.size(), 3U);
  EXPECT_NEAR(route.vertices[0].point.lat_deg, 46.9825392007, 1e-8) << "0.82 rad";
  EXPECT_NEAR(route.vertices[0].point.lon_deg, 8.0214091318, 1e-8);
  EXPECT_EQ(route.vertices[1].agl_m, 100);
  EXPECT_EQ(route.vertices[2].amsl_m, 640);
  EXPECT_TRUE(std::isnan(route.vertices[2].agl_m));
  EXPECT_EQ(route.vertices[1].speed_mps, 8);
  EXPECT_EQ(route.vertices[2].speed_mps, 5);
  EXPECT_EQ(route.vertices[2].source_item, 3);
  EXPECT_THAT(route.notes, Contains(HasSubstr("each is taken as that of the way to its waypoint")));
}

TEST(UgcsJson, TurnsThatCutCornersAreSaid) {
  const auto at = [](const std::string& lat, const std::string& lon, const std::string& turn) {
    return R"({"type": "Waypoint", "point": {"latitude": )" + lat + R"(, "longitude": )" + lon +
           R"(, "altitude": 100, "altitudeType": "AGL"}, "parameters": {"speed": 8, "cornerRadius": 30, "wpTurnType": ")" +
           turn + "\"}}";
  };
  const auto notes_with = [&](const std::string& turn) {
    return parse_route("r", ugcs_text(at("0", "0.14", turn) + "," + at("0.0001", "0.14", turn) + "," +
                                      at("0.0001", "0.1401", turn)))
        .notes;
  };
  EXPECT_THAT(notes_with("ADAPTIVE_BANK_TURN"), Contains(HasSubstr("which it leaves by 21 m at most")));
  EXPECT_THAT(notes_with("STOP_AND_TURN"), Not(Contains(HasSubstr("which it leaves"))));
}

TEST(UgcsJson, WhatIsNotReadIsNamed) {
  const std::string agl = R"(100, "altitudeType": "AGL")";
  EXPECT_THAT(route_error(ugcs_text(R"({"type": "AreaScan", "polygon": {}})")),
              HasSubstr("is of type AreaScan, and waypoints are read; export the route from UgCS as KML"));
  EXPECT_THAT(route_error(ugcs_text(ugcs_waypoint_text("8.02", agl, ""))), HasSubstr("which are no radians"));
  EXPECT_THAT(route_error(ugcs_text(ugcs_waypoint_text("0.14", R"(100, "altitudeType": "WGS84")", ""))),
              HasSubstr("AGL or AMSL"));
  EXPECT_THAT(route_error(ugcs_text(ugcs_waypoint_text("0.14", agl, R"("speed": -3)"))), HasSubstr("speed"));
  EXPECT_THAT(route_error(ugcs_text("")), HasSubstr("no position"));
}

}  // namespace
}  // namespace pilotage
