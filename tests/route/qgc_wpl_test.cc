#include "pilotage/route/qgc_wpl.h"

#include <algorithm>
#include <cmath>

#include "route/route_files.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/output_file.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using testing::route_error;
using testing::route_file;

const std::string kHead = "QGC WPL 110\n";
const std::string kHome = "0 1 0 16 0 0 0 0 47 8 400 1\n";

TEST(QgcWpl, ReadsHomeTakeoffReturnAcrossTheAntimeridian) {
  const Route route = read_route(route_file("mission.waypoints"));
  EXPECT_EQ(route.format, "QGC WPL 110");
  EXPECT_EQ(route.name, "mission.waypoints");
  ASSERT_TRUE(route.home);
  EXPECT_EQ(route.home->amsl_m, 12);
  ASSERT_EQ(route.vertices.size(), 4U);
  EXPECT_EQ(route.vertices[0].kind, "takeoff");
  EXPECT_EQ(route.vertices[0].point.lon_deg, 179.9);
  EXPECT_EQ(route.vertices[0].amsl_m, 72);
  EXPECT_EQ(route.vertices[2].amsl_m, 92);
  EXPECT_EQ(route.vertices[3].kind, "return");
  EXPECT_EQ(route.vertices[3].amsl_m, 92) << "returns at the height of the position before";
  ASSERT_EQ(route.legs.size(), 3U);
  // 0.02 degrees of longitude at 17.5 degrees south, not 359.98.
  EXPECT_NEAR(route.legs[1].length_m, 0.02 * 111319.49 * std::cos(17.5 * M_PI / 180), 20);
  ASSERT_EQ(route.items.size(), 7U);
  EXPECT_EQ(route.items[0].became, "home");
  EXPECT_THAT(route.items[4].became, HasSubstr("lat = lon = 0"));
  EXPECT_THAT(route.items[5].became, HasSubstr("not flown to"));
  EXPECT_EQ(route.items[6].became, "leg to home");
}

TEST(QgcWpl, LineEndsMarksAndBlanksDoNotMatter) {
  const std::string unix_text = kHead + kHome + "1 0 0 16 0 0 0 0 47.1 8 500 1\n2 0 0 16 0 0 0 0 47.2 8 500 1\n";
  std::string windows_text = "\xEF\xBB\xBF";
  for (const char c : unix_text) windows_text += c == '\n' ? "\t\r\n" : std::string(1, c);
  windows_text += "\r\n# a remark\r\n";
  const Route a = parse_route("r", unix_text);
  const Route b = parse_route("r", windows_text);
  ASSERT_EQ(a.vertices.size(), 2U);
  ASSERT_EQ(b.vertices.size(), 2U);
  EXPECT_EQ(route_length_m(a), route_length_m(b));
}

TEST(QgcWpl, RowZeroThatIsNoHomeIsFlown) {
  const Route route = parse_route("r", kHead +
                                           "0 1 5 22 0 0 0 0 47 8 450 1\n1 0 5 16 0 0 0 0 47.1 8 450 1\n"
                                           "2 0 5 20 0 0 0 0 47.1 8 0 1");
  ASSERT_EQ(route.vertices.size(), 3U);
  EXPECT_EQ(route.vertices[0].kind, "takeoff");
  EXPECT_TRUE(std::isnan(route.home->amsl_m));
  EXPECT_EQ(route.vertices[2].point.lat_deg, 47);
  EXPECT_THAT(route.notes, Contains(HasSubstr("stands in for home")));
}

// ArduPilot: "set to default_loc's altitude" where the altitude is 0, whatever its frame.
TEST(QgcWpl, AHeightOfZeroKeepsTheOneBefore) {
  const Route route = parse_route("r", kHead + kHome +
                                           "1 0 3 22 0 0 0 0 47 8 50 1\n"      // takeoff to 450 m
                                           "2 0 3 16 0 0 0 0 47.01 8 0 1\n"    // keeps it
                                           "3 0 0 16 0 0 0 0 47.02 8 600 1\n"  // above the sea
                                           "4 0 3 19 9 0 0 0 47.03 8 0 1\n"    // keeps that
                                           "5 0 10 16 0 0 0 0 47.04 8 80 1\n"  // above the ground
                                           "6 0 3 16 0 0 0 0 47.05 8 0 1\n"    // keeps that
                                           "7 0 3 21 0 0 0 0 47.06 8 0 1\n");  // a landing is on the ground
  ASSERT_EQ(route.vertices.size(), 7U);
  EXPECT_EQ(route.vertices[1].amsl_m, 450);
  EXPECT_EQ(route.vertices[3].amsl_m, 600);
  EXPECT_EQ(route.vertices[5].agl_m, 80);
  EXPECT_TRUE(std::isnan(route.vertices[5].amsl_m));
  EXPECT_EQ(route.vertices[6].amsl_m, 400);
  EXPECT_THAT(route.notes, Contains("3 items (the first: item 2) have a height of 0: the height before is kept, as "
                                    "ArduPilot flies. PX4 would fly at 0 m."));
}

TEST(QgcWpl, TheFirstHeightOfZeroIsTakenAsWritten) {
  const Route route = parse_route("r", kHead + kHome + "1 0 3 16 0 0 0 0 47 8 0 1\n2 0 3 16 0 0 0 0 47.1 8 60 1\n");
  EXPECT_EQ(route.vertices[0].amsl_m, 400);
  EXPECT_TRUE(std::none_of(route.notes.begin(), route.notes.end(),
                           [](const std::string& note) { return note.find("kept") != std::string::npos; }));
}

TEST(QgcWpl, ChangeOfAltitudeSetsTheHeightThatIsKept) {
  const Route route = parse_route("r", kHead + kHome +
                                           "1 0 3 16 0 0 0 0 47 8 60 1\n2 0 3 30 1 0 0 0 0 0 120 1\n"
                                           "3 0 3 16 0 0 0 0 47.1 8 0 1\n4 0 3 30 0 0 0 0 0 0 90 1\n"
                                           "5 0 3 16 0 0 0 0 47.2 8 70 1\n");
  ASSERT_EQ(route.vertices.size(), 3U);
  EXPECT_EQ(route.vertices[1].amsl_m, 520);
  EXPECT_EQ(route.vertices[2].amsl_m, 470) << "its own height";
  EXPECT_THAT(route.items[2].became, HasSubstr("height 520.0 m above sea level from here on"));
  EXPECT_THAT(route.notes, Contains(HasSubstr("Item 4 (continue and change altitude, to 490.0 m above sea level)")));
  RouteOptions options;
  options.agl_m = 100;
  EXPECT_EQ(parse_route("r",
                        kHead + kHome +
                            "1 0 3 16 0 0 0 0 47 8 60 1\n2 0 3 30 1 0 0 0 0 0 120 1\n"
                            "3 0 3 16 0 0 0 0 47.1 8 0 1\n",
                        options)
                .vertices[1]
                .agl_m,
            100);
}

TEST(QgcWpl, ErrorsNameTheLine) {
  EXPECT_THAT(route_error("QGC WPL 120\n" + kHome), HasSubstr("not \"QGC WPL 110\""));
  EXPECT_THAT(route_error(kHead), HasSubstr("has no items"));
  EXPECT_THAT(route_error(kHead + kHome), HasSubstr("no position to fly to"));
  EXPECT_THAT(route_error(kHead + kHome + "1 0 0 16 0 0 0 0 47.1 8 500\n"), HasSubstr("line 3: has 11 fields"));
  EXPECT_THAT(route_error(kHead + kHome + "1 0 0 16 0 0 0 0 nan 8 500 1\n"), HasSubstr("line 3: field 9 is \"nan\""));
  EXPECT_THAT(route_error(kHead + kHome + "1 0 0 16 0 0 0 0 4,7 8 500 1\n"), HasSubstr("field 9 is \"4,7\""));
  EXPECT_THAT(route_error(kHead + kHome + "1 0 0 16 0 0 0 0 91 8 500 1\n"), HasSubstr("latitude 91 is outside"));
  EXPECT_THAT(route_error(kHead + kHome + "1 0 0 16 0 0 0 0 47 181 500 1\n"), HasSubstr("longitude 181 is outside"));
  EXPECT_THAT(route_error(kHead + kHome + "0 0 0 16 0 0 0 0 47 8 500 1\n"), HasSubstr("does not follow"));
  EXPECT_THAT(route_error(kHead + kHome + "1 0 0.5 16 0 0 0 0 47 8 500 1\n"), HasSubstr("field 3"));
  EXPECT_THAT(route_error(kHead + kHome + "1 0 0 16 0 0 0 0 47 8 1e9 1\n"), HasSubstr("height 1e+09 m"));
  EXPECT_THAT(route_error(kHead + "0 1 0 16 0 0 0 0 0 0 0 1\n1 0 3 16 0 0 0 0 47 8 50 1\n"),
              HasSubstr("relative to home"));
  EXPECT_THAT(route_error(kHead + kHome + "1 0 3 16 0 0 0 0 47 8 50 1\n"), HasSubstr("all positions are at one place"));
}

TEST(QgcWpl, HeightOfHomeCanBeGiven) {
  RouteOptions options;
  options.home_amsl_m = 100;
  const std::string text =
      kHead + "0 1 0 16 0 0 0 0 0 0 0 1\n1 0 3 16 0 0 0 0 47 8 50 1\n2 0 3 16 0 0 0 0 47.1 8 60 1\n";
  EXPECT_EQ(parse_route("r", text, options).vertices[1].amsl_m, 160);
}

}  // namespace
}  // namespace pilotage
