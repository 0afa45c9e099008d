#include "pilotage/route/litchi_csv.h"

#include <cmath>
#include <string>

#include "route/route_files.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::route_error;

const std::string kLitchiHead =
    "latitude,longitude,altitude(m),curvesize(m),altitudemode,speed(m/s),gimbalpitchangle\n";

TEST(LitchiCsv, HeightsAndSpeedsAreThoseOfTheRows) {
  const std::string text = kLitchiHead + "47,8,100,0,1,8,-90\n47.01,8,120,0,1,4,-90\n47.02,8,120,0,1,0,-90\n";
  const Route route = parse_route("r", text);
  EXPECT_EQ(route.format, "Litchi CSV");
  ASSERT_EQ(route.vertices.size(), 3U);
  EXPECT_EQ(route.vertices[0].agl_m, 100);
  EXPECT_TRUE(std::isnan(route.vertices[0].amsl_m));
  EXPECT_EQ(route.vertices[1].speed_mps, 8) << "a speed is that to the next waypoint";
  EXPECT_EQ(route.vertices[2].speed_mps, 4);
  EXPECT_THAT(route.notes, Contains(HasSubstr("1 waypoints have speed 0, the mission's cruising speed")));
  EXPECT_EQ(route.vertices[2].source_item, 3);
}

TEST(LitchiCsv, HeightsAboveTheTakeOffNeedItsHeight) {
  const std::string text = "\xEF\xBB\xBFLongitude, Latitude ,altitude(ft)\r\n8,47,100\r\n8,47.01,200\r\n";
  const Route unknown = parse_route("r", text);
  EXPECT_TRUE(std::isnan(unknown.vertices[0].amsl_m));
  EXPECT_THAT(unknown.notes, Contains(HasSubstr("--home-amsl-m")));
  RouteOptions options;
  options.home_amsl_m = 400;
  EXPECT_NEAR(parse_route("r", text, options).vertices[1].amsl_m, 460.96, 1e-9) << "200 ft";
  options = {};
  options.agl_m = 80;
  const Route constant = parse_route("r", text, options);
  EXPECT_EQ(constant.vertices[0].agl_m, 80);
  EXPECT_THAT(constant.notes, Not(Contains(HasSubstr("--home-amsl-m"))));
}

TEST(LitchiCsv, CurvesAndGimbalAreSaid) {
  const Route route =
      parse_route("r", kLitchiHead + "0,8,100,0,1,8,-90\n0.01,8,100,30,1,8,-30\n0.01,8.01,100,0,1,8,-90\n");
  EXPECT_THAT(route.notes, Contains(HasSubstr("which it leaves by 21 m at most"))) << "30 m sin 45 degrees";
  EXPECT_THAT(route.notes, Contains(HasSubstr("At 1 of 3 waypoints the gimbal")));
}

TEST(LitchiCsv, OtherTablesAreToldWhatIsNeeded) {
  const std::string error = route_error("Latitude;Longitude;AltitudeAMSL\n47;8;400\n");
  EXPECT_THAT(error, HasSubstr("latitude, longitude and altitude(m) or altitude(ft), separated by commas"));
  EXPECT_THAT(route_error("lat,lon,alt\n47,8,100\n"), HasSubstr("this one has lat, lon, alt."));
}

TEST(LitchiCsv, WrongCellsAreNamed) {
  EXPECT_THAT(route_error(kLitchiHead + "47,8,x,0,1,8,-90\n"), HasSubstr("r: line 2: altitude(m) is \"x\""));
  EXPECT_THAT(route_error(kLitchiHead + "47,8,100,0,2,8,-90\n"), HasSubstr("altitudemode = 2; known are 0"));
  EXPECT_THAT(route_error(kLitchiHead + "97,8,100,0,1,8,-90\n"), HasSubstr("line 2: latitude 97 is outside"));
  EXPECT_THAT(route_error(kLitchiHead + "47,8,100,0,1,-8,-90\n"), HasSubstr("its speed, -8 m/s, is outside"));
  EXPECT_THAT(route_error(kLitchiHead + "47,8\n"), HasSubstr("line 2"));
}

TEST(LitchiCsv, ReadsARealMission) {
  const std::filesystem::path data = testing::real_data_folder();
  const std::filesystem::path file = data / "routes" / "drones" / "litchi.csv";
  if (data.empty() || !std::filesystem::exists(file)) GTEST_SKIP() << testing::kNoRealImagery;
  const Route route = read_route(file);
  ASSERT_EQ(route.vertices.size(), 2U);
  EXPECT_EQ(route.vertices[0].agl_m, 100);
  EXPECT_EQ(route.vertices[1].speed_mps, 8);
}

}  // namespace
}  // namespace pilotage
