#include "pilotage/route/dji_wpml.h"

#include <cmath>
#include <filesystem>
#include <string>

#include "route/route_files.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/route/corner_cut.h"

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::route_error;
using testing::route_file;

std::string dji_document(const std::string& inside) {
  return R"(<?xml version="1.0" encoding="UTF-8"?>
<kml xmlns="http://www.opengis.net/kml/2.2" xmlns:wpml="http://www.dji.com/wpmz/1.0.6"><Document>
<wpml:missionConfig><wpml:finishAction>goHome</wpml:finishAction>
<wpml:globalTransitionalSpeed>15</wpml:globalTransitionalSpeed>
<wpml:payloadInfo><wpml:payloadEnumValue>66</wpml:payloadEnumValue></wpml:payloadInfo></wpml:missionConfig>)" +
         inside + "</Document></kml>";
}

std::string executed(const std::string& mode, const std::string& placemarks, int id = 0) {
  return "<Folder><wpml:templateId>0</wpml:templateId><wpml:executeHeightMode>" + mode +
         "</wpml:executeHeightMode><wpml:waylineId>" + std::to_string(id) +
         "</wpml:waylineId><wpml:autoFlightSpeed>10</wpml:autoFlightSpeed>" + placemarks + "</Folder>";
}

std::string placemark(int index, const std::string& lon_lat, const std::string& more) {
  return "<Placemark><Point><coordinates>\n  " + lon_lat + "\n</coordinates></Point><wpml:index>" +
         std::to_string(index) + "</wpml:index>" + more + "</Placemark>";
}

std::string height(double height_m) {
  return "<wpml:executeHeight>" + std::to_string(height_m) + "</wpml:executeHeight>";
}

const std::string kTwoPlaces = placemark(0, "8,47", height(60)) + placemark(1, "8,47.01", height(80));

RouteOptions home_at(double amsl_m) {
  RouteOptions options;
  options.home_amsl_m = amsl_m;
  return options;
}

TEST(DjiWpml, HeightsAboveTheTakeOffNeedItsHeight) {
  const std::string text = dji_document(executed("relativeToStartPoint", kTwoPlaces));
  const Route unknown = parse_route("r", text);
  EXPECT_EQ(unknown.format, "DJI mission");
  EXPECT_TRUE(std::isnan(unknown.vertices[0].amsl_m));
  EXPECT_TRUE(std::isnan(unknown.vertices[0].agl_m));
  EXPECT_THAT(unknown.notes, Contains(HasSubstr("--home-amsl-m")));
  const Route known = parse_route("r", text, home_at(400));
  EXPECT_EQ(known.vertices[0].amsl_m, 460);
  EXPECT_EQ(known.vertices[1].amsl_m, 480);
  EXPECT_THAT(known.notes, Contains(HasSubstr("lies at 400 m above sea level, as the options say")));
}

TEST(DjiWpml, HeightsFollowTheirMode) {
  // The ellipsoid lies 48 m below sea level near 47° N 8° E (EGM96).
  const Route ellipsoid = parse_route("r", dji_document(executed("WGS84", kTwoPlaces)));
  EXPECT_NEAR(ellipsoid.vertices[0].amsl_m, 60 - 48, 3);
  const Route ground = parse_route("r", dji_document(executed("realTimeFollowSurface", kTwoPlaces)));
  EXPECT_EQ(ground.vertices[1].agl_m, 80);
  EXPECT_TRUE(std::isnan(ground.vertices[1].amsl_m));
  EXPECT_THAT(ellipsoid.notes, Not(Contains(HasSubstr("tells no heights"))));
  EXPECT_THAT(route_error(dji_document(executed("barometer", kTwoPlaces))),
              HasSubstr("its executeHeightMode is \"barometer\"; known are WGS84"));
}

TEST(DjiWpml, WaypointsAreFlownInTheOrderOfTheirIndex) {
  const std::string swapped = placemark(1, "8,47.01", height(80)) + placemark(0, "8,47", height(60));
  const Route route = parse_route("r", dji_document(executed("realTimeFollowSurface", swapped)));
  EXPECT_EQ(route.vertices[0].point.lat_deg, 47);
  EXPECT_EQ(route.vertices[1].agl_m, 80);
  const std::string twice = placemark(1, "8,47", height(80)) + placemark(1, "8,47.01", height(60));
  EXPECT_THAT(route_error(dji_document(executed("WGS84", twice))), HasSubstr("the waypoint index 1 stands twice"));
}

TEST(DjiWpml, ASpeedIsThatToTheNextWaypoint) {
  const std::string text = dji_document(executed(
      "realTimeFollowSurface", placemark(0, "8,47", height(60) + "<wpml:waypointSpeed>4</wpml:waypointSpeed>") +
                                   placemark(1, "8,47.01", height(60)) + placemark(2, "8,47.02", height(60))));
  const Route route = parse_route("r", text);
  EXPECT_EQ(route.vertices[1].speed_mps, 4);
  EXPECT_EQ(route.vertices[2].speed_mps, 10) << "autoFlightSpeed";
}

TEST(DjiWpml, SeveralWaylinesAreFlownByTheirIdOrChosen) {
  const std::string second = placemark(0, "8.1,47", height(60)) + placemark(1, "8.1,47.01", height(60));
  const std::string text =
      dji_document(executed("realTimeFollowSurface", second, 1) + executed("realTimeFollowSurface", kTwoPlaces, 0));
  const Route all = parse_route("r", text);
  ASSERT_EQ(all.vertices.size(), 4U);
  EXPECT_EQ(all.vertices[0].point.lon_deg, 8);
  EXPECT_EQ(all.vertices[2].speed_mps, 15) << "globalTransitionalSpeed between waylines";
  EXPECT_EQ(all.legs.size(), 3U);
  EXPECT_THAT(all.notes, Contains(HasSubstr("2 waylines of the file are flown one after another")));
  RouteOptions options;
  options.feature = "2";
  EXPECT_EQ(parse_route("r", text, options).vertices[0].point.lon_deg, 8.1);
  options.feature = "3";
  EXPECT_THAT(route_error(text, options), HasSubstr("has 2 waylines, numbered from 1; \"3\" is none of them"));
  options = {};
  options.height_reference = HeightReference::kAgl;
  EXPECT_THAT(route_error(text, options), HasSubstr("r is a mission file"));
}

TEST(DjiWpml, MissingHeightsAreSaid) {
  const Route route = parse_route(
      "r",
      dji_document(executed("realTimeFollowSurface", placemark(0, "8,47", height(60)) + placemark(1, "8,47.01", ""))));
  EXPECT_TRUE(std::isnan(route.vertices[1].agl_m));
  EXPECT_THAT(route.notes, Contains(HasSubstr("1 of 2 waypoints have no height")));
}

TEST(DjiWpml, ThePayloadIsTheCamera) {
  const Route route = parse_route("r", dji_document(executed("WGS84", kTwoPlaces)));
  ASSERT_TRUE(route.camera);
  EXPECT_EQ(route.camera->name, "DJI Mavic 3E");
  EXPECT_EQ(route.camera->image_width_px, 5280);
  EXPECT_THAT(route.notes, Contains(HasSubstr("payload 66, DJI Mavic 3E")));
  std::string other = dji_document(executed("WGS84", kTwoPlaces));
  other.replace(other.find(">66<"), 4, ">65534<");
  const Route unknown = parse_route("r", other);
  EXPECT_FALSE(unknown.camera);
  EXPECT_THAT(unknown.notes, Contains(HasSubstr("payload 65534, whose camera is not in the table")));
}

TEST(DjiWpml, TurnsThatCutCornersAreMeasured) {
  const auto turn = [](const std::string& mode) {
    return height(60) + "<wpml:waypointTurnParam><wpml:waypointTurnMode>" + mode +
           "</wpml:waypointTurnMode><wpml:waypointTurnDampingDist>20</wpml:waypointTurnDampingDist>"
           "</wpml:waypointTurnParam><wpml:useStraightLine>0</wpml:useStraightLine>";
  };
  const auto route_of = [&](const std::string& mode) {
    return parse_route(
        "r", dji_document(executed("WGS84", placemark(0, "8,0", height(60)) + placemark(1, "8,0.01", turn(mode)) +
                                                placemark(2, "8.01,0.01", height(60)))));
  };
  // A right angle: 20 m · sin 45°.
  EXPECT_THAT(route_of("coordinateTurn").notes, Contains(HasSubstr("which it leaves by 14 m at most")));
  EXPECT_THAT(route_of("toPointAndStopWithDiscontinuityCurvature").notes, Not(Contains(HasSubstr("leaves by"))));
  EXPECT_THAT(route_of("toPointAndPassWithContinuityCurvature").notes,
              Contains(HasSubstr("1 waypoints are flown along curves")));
}

TEST(DjiWpml, CornerCutIsLimitedByTheLegs) {
  const GeodeticPoint before{8, 0};
  const GeodeticPoint corner{8, 0.01};
  const GeodeticPoint after{8.01, 0.01};
  EXPECT_NEAR(corner_cut_m(before, corner, after, 20), 20 * std::sqrt(0.5), 0.01);
  EXPECT_NEAR(corner_cut_m(before, corner, after, 1e6), 1105.7 * std::sqrt(0.5), 1) << "the shorter leg";
  EXPECT_NEAR(corner_cut_m(before, corner, before, 20), 20, 1e-6) << "straight back";
  EXPECT_EQ(corner_cut_m(before, corner, after, 0), 0);
}

const std::string kTemplateFolder =
    "<Folder><wpml:templateType>waypoint</wpml:templateType><wpml:templateId>0</wpml:templateId>"
    "<wpml:waylineCoordinateSysParam><wpml:heightMode>EGM96</wpml:heightMode></wpml:waylineCoordinateSysParam>"
    "<wpml:autoFlightSpeed>7</wpml:autoFlightSpeed>";

TEST(DjiWpml, ATemplateServesWhereThereAreNoWaylines) {
  const Route route =
      parse_route("r", dji_document(kTemplateFolder + placemark(0, "8,47", "<wpml:height>500</wpml:height>") +
                                    placemark(1, "8,47.01", "<wpml:height>520</wpml:height>") + "</Folder>"));
  EXPECT_EQ(route.vertices[1].amsl_m, 520);
  EXPECT_EQ(route.vertices[1].speed_mps, 7);
  EXPECT_THAT(route.notes, Contains(HasSubstr("The path is that of the template")));
  EXPECT_THAT(route_error(dji_document(kTemplateFolder + "<Placemark><Polygon/></Placemark></Folder>")),
              HasSubstr("holds an area or settings and no path"));
}

// The archive holds both documents; the path, and the template's take-off, 100 m above the ellipsoid at 47° N 8° E.
TEST(DjiWpml, AnArchiveGivesThePathAndTheTakeOff) {
  const Route route = read_route(route_file("dji.kmz"));
  EXPECT_EQ(route.format, "DJI mission (KMZ)");
  ASSERT_TRUE(route.home);
  EXPECT_NEAR(route.home->amsl_m, 100 - 48, 3);
  ASSERT_EQ(route.vertices.size(), 3U);
  EXPECT_NEAR(route.vertices[0].amsl_m, route.home->amsl_m + 60, 1e-9);
  EXPECT_EQ(route.vertices[1].speed_mps, 6);
  EXPECT_EQ(read_route(route_file("dji.kmz"), home_at(300)).vertices[0].amsl_m, 360);
}

TEST(DjiWpml, DamageIsNamed) {
  EXPECT_THAT(route_error(dji_document(executed("WGS84", placemark(0, "8;47", height(1))))),
              HasSubstr("waypoint of index 0: coordinates"));
  EXPECT_THAT(route_error(dji_document(executed("WGS84", placemark(0, "8,97", height(1))))),
              HasSubstr("latitude 97 is outside"));
  EXPECT_THAT(
      route_error(dji_document(executed("WGS84", placemark(0, "8,47", "<wpml:executeHeight>x</wpml:executeHeight>")))),
      HasSubstr("executeHeight is \"x\", expected a finite number"));
  EXPECT_THAT(route_error(dji_document(executed("WGS84", ""))), HasSubstr("its waylines hold no waypoint"));
  const std::string cut = dji_document(executed("WGS84", kTwoPlaces)).substr(0, 700);
  EXPECT_THAT(route_error(cut), HasSubstr("r: "));
}

TEST(DjiWpml, RealMissionsGiveTheirPath) {
  const std::filesystem::path data = testing::real_data_folder();
  const std::filesystem::path folder = data / "routes" / "drones";
  if (data.empty() || !std::filesystem::exists(folder / "dji_1.kmz")) GTEST_SKIP() << testing::kNoRealImagery;
  RouteOptions first;
  first.feature = "1";
  const Route mapping = read_route(folder / "dji_1.kmz", first);
  // The file's own length of its wayline.
  EXPECT_NEAR(route_length_m(mapping), 1585.9, 20);
  EXPECT_THAT(read_route(folder / "dji_1.kmz").notes, Contains(HasSubstr("The 5 waylines of the file")));
  EXPECT_NEAR(mapping.vertices[0].amsl_m, 330.87, 1) << "ellipsoidHeight 327.37 of the template, height 330.87 there";
  EXPECT_EQ(mapping.vertices[1].speed_mps, 9);
  ASSERT_TRUE(mapping.camera);
  EXPECT_EQ(mapping.camera->name, "DJI Matrice 30T");
  const Route seed = read_route(folder / "seed.kmz", home_at(250));
  EXPECT_EQ(seed.vertices[1].amsl_m, 260);
  EXPECT_EQ(seed.vertices[1].speed_mps, 15);
  EXPECT_NEAR(route_length_m(seed), 121.03, 0.5);
}

}  // namespace
}  // namespace pilotage
