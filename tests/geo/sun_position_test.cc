#include "pilotage/geo/sun_position.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

SunPosition sun_at(double lon_deg, double lat_deg, const char* time) {
  return sun_position({lon_deg, lat_deg}, parse_utc_time(time).value());
}

// I. Reda, A. Andreas: Solar Position Algorithm for Solar Radiation Applications, NREL/TP-560-34302, 2008, table A5.1:
// Golden, Colorado, 12:30:30 local time (UTC − 7 h); its elevation before refraction.
TEST(SunPosition, AgreesWithThePublishedExample) {
  const SunPosition sun = sun_at(-105.1786, 39.742476, "2003-10-17T19:30:30Z");
  EXPECT_NEAR(sun.elevation_deg, 39.872046, 0.003);  // the parallax is left out
  EXPECT_NEAR(sun.azimuth_deg, 194.340241, 0.003);
}

// At the north pole the sun is as high as its declination: J. Meeus, Astronomical Algorithms, 1998, example 25.a.
TEST(SunPosition, StandsAtItsDeclinationOverThePole) {
  EXPECT_NEAR(sun_at(0, 90, "1992-10-13T00:00:00Z").elevation_deg, -7.78507, 0.001);
  EXPECT_NEAR(sun_at(120, -90, "1992-10-13T00:00:00Z").elevation_deg, 7.78507, 0.001);
}

TEST(SunPosition, GoesFromEastBySouthToWest) {
  EXPECT_NEAR(sun_at(0, 50, "2024-03-20T06:07:00Z").azimuth_deg, 90, 1);  // at an equinox, with the equation of time
  EXPECT_NEAR(sun_at(0, 50, "2024-03-20T12:07:00Z").azimuth_deg, 180, 1);
  EXPECT_NEAR(sun_at(0, 50, "2024-03-20T12:07:00Z").elevation_deg, 40, 0.2);
  EXPECT_NEAR(sun_at(0, 50, "2024-03-20T18:07:00Z").azimuth_deg, 270, 1);
  EXPECT_NEAR(sun_at(0, -50, "2024-03-20T12:07:00Z").azimuth_deg,
              std::round(sun_at(0, -50, "2024-03-20T12:07:00Z").azimuth_deg / 360) * 360, 1);
}

TEST(SunPosition, IsTheSameAcrossTheDateLine) {
  const SunPosition east = sun_at(180, 10, "2026-06-01T00:00:00Z");
  const SunPosition west = sun_at(-180, 10, "2026-06-01T00:00:00Z");
  EXPECT_NEAR(east.azimuth_deg, west.azimuth_deg, 1e-6);
  EXPECT_NEAR(east.elevation_deg, west.elevation_deg, 1e-6);
}

}  // namespace
}  // namespace pilotage
