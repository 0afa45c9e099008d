#include "pilotage/route/ugcs_csv.h"

#include <cmath>
#include <string>

#include "route/route_files.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::route_error;

TEST(UgcsCsv, HeightsAreThoseThatTheColumnNames) {
  const Route sea =
      parse_route("r", "\xEF\xBB\xBFWP,Latitude,Longitude,AltitudeAMSL,Speed\r\n1,47,8,500,9\r\n2,47.01,8,520,9\r\n");
  EXPECT_EQ(sea.format, "UgCS CSV");
  ASSERT_EQ(sea.vertices.size(), 2U);
  EXPECT_EQ(sea.vertices[1].amsl_m, 520);
  EXPECT_TRUE(std::isnan(sea.vertices[1].agl_m));
  EXPECT_EQ(sea.vertices[1].speed_mps, 9);
  EXPECT_EQ(sea.vertices[1].source_item, 2);
  EXPECT_THAT(sea.notes, IsEmpty());
  const Route ground = parse_route("r",
                                   "Latitude,Longitude,AltitudeAGL,Speed,Picture,WP,CameraTilt,UavYaw,WaitTime\n47,8,"
                                   "50,3,TRUE,1,90,0,2\n47.01,8,60,3,FALSE,2,,,\n");
  EXPECT_EQ(ground.vertices[0].agl_m, 50);
  EXPECT_TRUE(std::isnan(ground.vertices[0].amsl_m));
}

TEST(UgcsCsv, OfTwoHeightsTheOneAboveSeaLevelIsTaken) {
  const Route route = parse_route(
      "r", "Latitude,Longitude,AltitudeAMSL,AltitudeAGL,Speed\n47,8,500,60,3\n47.01,8,,70,4\n47.02,8,520,70,\n");
  EXPECT_EQ(route.vertices[0].amsl_m, 500);
  EXPECT_TRUE(std::isnan(route.vertices[0].agl_m));
  EXPECT_EQ(route.vertices[1].agl_m, 70);
  EXPECT_TRUE(std::isnan(route.vertices[2].speed_mps));
  EXPECT_THAT(route.notes, Contains(HasSubstr("2 of 3 waypoints have AltitudeAMSL and AltitudeAGL")));
  EXPECT_THAT(route.notes, Contains(HasSubstr("speeds of the waypoints differ")));
}

TEST(UgcsCsv, SaysWhatIsMissingOrWrong) {
  EXPECT_THAT(route_error("WP,Lat,Longitude,AltitudeAGL\n1,47,8,50\n"), HasSubstr("no column Latitude;"));
  EXPECT_THAT(route_error("WP,AltitudeAMSL\n1,47\n"), HasSubstr("no column Latitude, Longitude; needed are"));
  EXPECT_THAT(route_error("Latitude,Longitude,AltitudeAGL\n47,8,50\n47.01,8,\n"),
              HasSubstr("line 3: has neither AltitudeAMSL nor AltitudeAGL"));
  EXPECT_THAT(route_error("Latitude,Longitude,AltitudeAGL,Speed\n47,8,50,0\n"), HasSubstr("outside (0, 1000]"));
  EXPECT_THAT(route_error("Latitude,Longitude,AltitudeAGL\n97,8,50\n"), HasSubstr("line 2"));
  EXPECT_THAT(route_error("Latitude,Longitude,AltitudeAGL\n47,eight,50\n"),
              HasSubstr("Longitude is \"eight\", expected a finite number"));
}

// Both write Latitude and Longitude; Litchi names the unit of its heights.
TEST(UgcsCsv, IsToldFromLitchi) {
  EXPECT_EQ(parse_route("r", "latitude,longitude,altitude(m)\n47,8,50\n47.01,8,50\n").format, "Litchi CSV");
  EXPECT_THAT(route_error("Latitude,Longitude,Altitude\n47,8,50\n"),
              HasSubstr("those of UgCS, which name Latitude, Longitude and AltitudeAMSL or AltitudeAGL; this one has "
                        "Latitude, Longitude, Altitude."));
}

}  // namespace
}  // namespace pilotage
