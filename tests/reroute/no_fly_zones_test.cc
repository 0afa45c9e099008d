#include "pilotage/reroute/no_fly_zones.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

const Crs& grid() {
  static const Crs crs = Crs::from_user_input("EPSG:32633");
  return crs;
}

GeodeticPoint at(double x_m, double y_m) {
  return CrsTransform(grid()).geodetic_from_map({500000 + x_m, 5'000'000 + y_m}).value();
}

GeodeticArea box(double west, double south, double east, double north) {
  return {{{at(west, south), at(east, south), at(east, north), at(west, north)}}};
}

Eigen::Vector2d m(double x_m, double y_m) {
  return {500000 + x_m, 5'000'000 + y_m};
}

TEST(NoFlyZones, ALineMustNotCrossEvenWhenItsEndsAreOutside) {
  const ZonesOnGrid zones({{{box(100, 100, 200, 200), "z", false}}}, grid());
  EXPECT_TRUE(zones.clear(m(0, 0), m(300, 0)));
  EXPECT_FALSE(zones.clear(m(0, 150), m(300, 150)));
  EXPECT_FALSE(zones.clear(m(120, 120), m(180, 180))) << "inside from end to end";
  EXPECT_FALSE(zones.clear(m(90, 180), m(130, 220))) << "over a corner";
  EXPECT_EQ(zones.forbidden_by(m(150, 150)), "z");
  EXPECT_EQ(zones.forbidden_by(m(50, 50)), "");
}

TEST(NoFlyZones, AHoleMayBeFlownIn) {
  GeodeticArea ring = box(0, 0, 300, 300);
  ring.rings.push_back(box(100, 100, 200, 200).rings.front());
  const ZonesOnGrid zones({{{ring, "z", false}}}, grid());
  EXPECT_TRUE(zones.clear(m(120, 120), m(180, 180)));
  EXPECT_FALSE(zones.clear(m(120, 120), m(180, 250)));
}

TEST(NoFlyZones, AMarginIsKeptOnBothSides) {
  NoFlyZones given{{{box(100, 100, 200, 200), "z", false}, {box(-500, -500, 500, 500), "fence", true}}};
  given.margin_m = 20;
  const ZonesOnGrid zones(given, grid());
  EXPECT_TRUE(zones.clear(m(0, 79), m(300, 79)));
  EXPECT_FALSE(zones.clear(m(0, 81), m(300, 81)));
  EXPECT_TRUE(zones.clear(m(-479, 0), m(-479, 50)));
  EXPECT_FALSE(zones.clear(m(-481, 0), m(-481, 50)));
  EXPECT_EQ(zones.forbidden_by(m(-481, 0)), "fence");
}

// ArduPilot wants all of the inclusions, PX4 any.
TEST(NoFlyZones, SeveralInclusionsMeetOrJoinAsTheAutopilotWants) {
  NoFlyZones given{{{box(0, 0, 200, 100), "a", true}, {box(150, 0, 400, 100), "b", true}}};
  EXPECT_FALSE(ZonesOnGrid(given, grid()).clear(m(50, 50), m(170, 50)));
  EXPECT_TRUE(ZonesOnGrid(given, grid()).clear(m(160, 50), m(190, 50)));
  given.inside_any = true;
  EXPECT_TRUE(ZonesOnGrid(given, grid()).clear(m(50, 50), m(350, 50)));
  EXPECT_FALSE(ZonesOnGrid(given, grid()).clear(m(50, 50), m(450, 50)));
}

TEST(NoFlyZones, SaysHowMuchOfALineIsForbidden) {
  std::vector<FlightSample> samples;
  for (int i = 0; i <= 40; ++i) {
    FlightSample sample;
    sample.point = at(10.0 * i, 50);
    sample.distance_m = 10.0 * i;
    samples.push_back(sample);
  }
  NoFlyZones zones{{{box(100, 0, 200, 100), "z", false}}};
  EXPECT_NEAR(forbidden_way(zones, samples).length_m, 100, 0.2);
  EXPECT_EQ(forbidden_way(zones, samples).source, "z");
  zones.zones = {{box(-10, 0, 300, 100), "fence", true}};
  EXPECT_NEAR(forbidden_way(zones, samples).length_m, 100, 0.2);
  zones.zones.push_back({box(290, 0, 500, 100), "fence", true});
  EXPECT_NEAR(forbidden_way(zones, samples).length_m, 100 + 290, 0.5) << "outside the one, and outside the other";
  zones.inside_any = true;
  EXPECT_EQ(forbidden_way(zones, samples).length_m, 0);
}

}  // namespace
}  // namespace pilotage
