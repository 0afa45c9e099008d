#include "pilotage/route/dji_wpml_writer.h"

#include <cmath>
#include <string>

#include "route/route_files.h"
#include "testing/source_folder.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_xml.h"

namespace pilotage {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::route_file;
using testing::TemporaryFolder;

// What our own reader makes of the KMZ.
Route read_back(const Route& route, const std::string& camera = "") {
  const TemporaryFolder folder;
  write_dji_mission(folder / "mission.kmz", dji_mission_of(route, camera), false);
  return read_route(folder / "mission.kmz");
}

// The vertices in the order of flight.
std::vector<RouteVertex> line_of(const Route& route) {
  std::vector<RouteVertex> line = {route.vertices[static_cast<std::size_t>(route.legs.front().from)]};
  for (const RouteLeg& leg : route.legs) {
    const auto from = static_cast<std::size_t>(leg.from);
    const RouteVertex& last = line.back();
    const bool climbs = route.vertices[from].amsl_m != last.amsl_m && !std::isnan(last.amsl_m);
    if (climbs) line.push_back(route.vertices[from]);
    line.push_back(route.vertices[static_cast<std::size_t>(leg.to)]);
  }
  return line;
}

void expect_same_line(const Route& route, const Route& back) {
  const std::vector<RouteVertex> expected = line_of(route);
  const std::vector<RouteVertex> found = line_of(back);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    SCOPED_TRACE("waypoint " + std::to_string(i + 1));
    EXPECT_NEAR(found[i].point.lon_deg, expected[i].point.lon_deg, 1e-7);
    EXPECT_NEAR(found[i].point.lat_deg, expected[i].point.lat_deg, 1e-7);
    if (std::isnan(expected[i].agl_m)) {
      EXPECT_NEAR(found[i].amsl_m, expected[i].amsl_m, 0.01);
    } else {
      EXPECT_NEAR(found[i].agl_m, expected[i].agl_m, 0.01);
    }
    if (i > 0) {
      EXPECT_DOUBLE_EQ(found[i].speed_mps, expected[i].speed_mps);
    }
  }
}

Route three_places(double RouteVertex::*height_m) {
  Route route;
  route.name = "three.plan";
  const double speeds_mps[] = {10, 10, 12.5};
  for (int i = 0; i < 3; ++i) {
    RouteVertex vertex;
    vertex.point = {8.123456789 + 0.01 * i, 47.987654321 - 0.02 * i};
    vertex.*height_m = 120.004 + 30 * i;
    vertex.speed_mps = speeds_mps[i];
    route.vertices.push_back(vertex);
  }
  route.legs = {{0, 1, 2300}, {1, 2, 2300}};
  return route;
}

TEST(DjiWpmlWriter, APlanComesBackWithItsLineHeightsAndSpeeds) {
  RouteOptions options;
  options.home_amsl_m = 400;
  options.speed_mps = 14;
  const Route route = read_route(testing::source_folder() / "maps/sample/route.plan", options);
  const Route back = read_back(route);
  EXPECT_EQ(back.format, "DJI mission (KMZ)");
  expect_same_line(route, back);
  ASSERT_TRUE(back.home.has_value());
  EXPECT_NEAR(back.home->amsl_m, 400, 0.01) << "the reference take-off point";
  EXPECT_FALSE(back.camera.has_value());
}

TEST(DjiWpmlWriter, HeightsAboveSeaLevelAreExecutedAboveTheEllipsoid) {
  const Route route = three_places(&RouteVertex::amsl_m);
  expect_same_line(route, read_back(route));
  const DjiMission mission = dji_mission_of(route, "");
  EXPECT_THAT(mission.waylines, HasSubstr("<wpml:executeHeightMode>WGS84</wpml:executeHeightMode>"));
  EXPECT_THAT(mission.mission_template, HasSubstr("<wpml:heightMode>EGM96</wpml:heightMode>"));
  EXPECT_THAT(mission.mission_template, HasSubstr("<wpml:height>120.004</wpml:height>"));
  const XmlElement document = *parse_xml("w", mission.waylines).child("Document");
  const XmlElement first = *document.child("Folder")->child("Placemark");
  const double executed_m = std::stod(first.child_text("executeHeight"));
  EXPECT_NEAR(executed_m, 120.004 + 48.5, 1.5) << "EGM96 lies some 48 m above the ellipsoid at 8° E, 48° N";
  EXPECT_EQ(first.child_text("waypointSpeed"), "10") << "a DJI speed is that to the next waypoint";
  EXPECT_THAT(mission.waylines, HasSubstr("<wpml:waypointSpeed>12.5</wpml:waypointSpeed>"));
}

TEST(DjiWpmlWriter, HeightsAboveGroundFollowTheSurface) {
  const Route route = three_places(&RouteVertex::agl_m);
  expect_same_line(route, read_back(route));
  const DjiMission mission = dji_mission_of(route, "");
  EXPECT_THAT(mission.waylines, HasSubstr("<wpml:executeHeightMode>realTimeFollowSurface<"));
  EXPECT_THAT(mission.mission_template, HasSubstr("<wpml:heightMode>aboveGroundLevel<"));
}

TEST(DjiWpmlWriter, TheTemplateAloneIsTheSameRoute) {
  const Route route = three_places(&RouteVertex::amsl_m);
  expect_same_line(route, parse_route("template.kml", dji_mission_of(route, "").mission_template));
}

TEST(DjiWpmlWriter, AircraftIsNamedWhereTheCameraIsItsOwn) {
  const Route route = three_places(&RouteVertex::amsl_m);
  const DjiMission mission = dji_mission_of(route, "DJI Mavic 3T");
  for (const std::string& text : {mission.mission_template, mission.waylines}) {
    EXPECT_THAT(text, HasSubstr("<wpml:droneEnumValue>77</wpml:droneEnumValue>\n"
                                "<wpml:droneSubEnumValue>1</wpml:droneSubEnumValue>"));
    EXPECT_THAT(text, HasSubstr("<wpml:payloadEnumValue>67</wpml:payloadEnumValue>"));
  }
  EXPECT_EQ(read_back(route, "DJI Mavic 3T").camera->name, "DJI Mavic 3T");
  EXPECT_THAT(dji_mission_of(route, "Sony a7R III 35mm").waylines, Not(HasSubstr("droneInfo")));
}

TEST(DjiWpmlWriter, LandingIsLeftToTheAircraft) {
  Route route = three_places(&RouteVertex::amsl_m);
  route.vertices[2].on_ground = true;
  EXPECT_EQ(read_back(route).vertices.size(), 2U);
  route.vertices[2].on_ground = false;
  route.vertices[1].on_ground = true;
  EXPECT_THAT(error_of<DataError>([&] { dji_mission_of(route, ""); }), HasSubstr("lands on its way"));
}

TEST(DjiWpmlWriter, SaysWhatADjiMissionCannotHold) {
  Route route = three_places(&RouteVertex::amsl_m);
  route.vertices[1].agl_m = 100;
  EXPECT_THAT(error_of<DataError>([&] { dji_mission_of(route, ""); }), HasSubstr("one kind"));
  route = three_places(&RouteVertex::amsl_m);
  route.vertices[1].amsl_m = std::nan("");
  EXPECT_THAT(error_of<DataError>([&] { dji_mission_of(route, ""); }), HasSubstr("waypoint 2 has no height"));
  route = three_places(&RouteVertex::amsl_m);
  route.vertices[2].speed_mps = std::nan("");
  EXPECT_THAT(error_of<DataError>([&] { dji_mission_of(route, ""); }), HasSubstr("waypoint 2 has no speed"));
}

TEST(DjiWpmlWriter, TheSameBytesEachTime) {
  const Route route = three_places(&RouteVertex::amsl_m);
  const TemporaryFolder folder;
  write_dji_mission(folder / "a.kmz", dji_mission_of(route, ""), false);
  write_dji_mission(folder / "b.kmz", dji_mission_of(route, ""), false);
  EXPECT_EQ(read_file(folder / "a.kmz", 1 << 20), read_file(folder / "b.kmz", 1 << 20));
}

}  // namespace
}  // namespace pilotage
