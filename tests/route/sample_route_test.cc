#include "pilotage/route/sample_route.h"

#include <cmath>

#include "route/route_files.h"
#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/route/route_builder.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

Route route_of(const std::vector<RouteVertex>& vertices) {
  Route route;
  route.name = "r";
  for (const RouteVertex& vertex : vertices) {
    const int index = append_vertex(route, vertex);
    if (index > 0) append_leg(route, index - 1, index);
  }
  return route;
}

RouteVertex at(double lat_deg, double lon_deg, double amsl_m, double agl_m) {
  return {.point = {lon_deg, lat_deg},
          .amsl_m = amsl_m,
          .agl_m = agl_m,
          .speed_mps = 20,
          .source_item = 0,
          .kind = "waypoint"};
}

std::string sample_error(const Route& route, double step_m, const TerrainHeight& terrain = {}) {
  return testing::error_of<std::exception>([&] { sample_route(route, step_m, terrain); });
}

TEST(SampleRoute, FollowsTheGeodesicAtEvenSteps) {
  const Route route = route_of({at(60, -20, kNone, 100), at(61, 20, kNone, 200), at(61, 21, kNone, 200)});
  const auto samples = sample_route(route, 1000);
  const GeodesicLeg geodesic = geodesic_between({-20, 60}, {20, 61});
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const RouteSample& sample = samples[i];
    if (i > 0) {
      EXPECT_LE(sample.distance_m - samples[i - 1].distance_m, 1000 + 1e-6);
    }
    if (sample.leg != 0) continue;
    // On the geodesic, the distances to both ends add up to its length.
    const double before = geodesic_between({-20, 60}, sample.point).length_m;
    const double after = geodesic_between(sample.point, {20, 61}).length_m;
    EXPECT_NEAR(before + after, geodesic.length_m, 1e-6);
    EXPECT_NEAR(before, sample.distance_m, 1e-6);
    EXPECT_NEAR(sample.agl_m, 100 + 100 * sample.distance_m / geodesic.length_m, 1e-6);
    EXPECT_EQ(sample.speed_mps, 20);
  }
  EXPECT_NEAR(samples.front().azimuth_deg, geodesic.start_azimuth_deg, 1e-9);
  EXPECT_NEAR(samples.back().distance_m, route_length_m(route), 1e-6);
  // The highest point of the great circle lies north of both ends: a straight line on the map would not.
  double north = 0;
  for (const RouteSample& sample : samples) north = std::max(north, sample.point.lat_deg);
  EXPECT_GT(north, 62);
}

TEST(SampleRoute, AzimuthIsTheDirectionToTheNextSample) {
  const Route route =
      route_of({at(-17, 179.9, kNone, 100), at(-17.1, -179.9, kNone, 100), at(-17.1, 179.8, kNone, 100)});
  const auto samples = sample_route(route, 500);
  for (std::size_t i = 0; i + 1 < samples.size(); ++i) {
    if (samples[i].leg != samples[i + 1].leg) continue;
    const double direction = geodesic_between(samples[i].point, samples[i + 1].point).start_azimuth_deg;
    EXPECT_NEAR(std::remainder(direction - samples[i].azimuth_deg, 360.0), 0, 1e-4);
    EXPECT_GE(samples[i].azimuth_deg, 0);
    EXPECT_LT(samples[i].azimuth_deg, 360);
  }
}

TEST(SampleRoute, HeightsAboveGroundComeFromTerrain) {
  const Route route = route_of({at(47, 8, 600, kNone), at(47, 8.1, 800, kNone)});
  const auto ground = [](GeodeticPoint point) { return 400 + 1000 * (point.lon_deg - 8); };
  for (const RouteSample& sample : sample_route(route, 100, ground)) {
    EXPECT_NEAR(sample.amsl_m, 600 + 200 * sample.distance_m / route_length_m(route), 1e-6);
    EXPECT_NEAR(sample.agl_m, sample.amsl_m - ground(sample.point), 1e-9);
  }
  EXPECT_THAT(sample_error(route, 100), HasSubstr("give --elevation or --agl-m"));
  const auto hole = [](GeodeticPoint point) { return point.lon_deg > 8.05 ? kNone : 400; };
  EXPECT_THAT(sample_error(route, 100, hole), HasSubstr("the elevation model has no height at lat 47.0000"));
}

TEST(SampleRoute, TerrainHeightsNeedNoElevation) {
  const Route route = route_of({at(47, 8, kNone, 120), at(47, 8.1, kNone, 120)});
  for (const RouteSample& sample : sample_route(route, 1000)) {
    EXPECT_EQ(sample.agl_m, 120);
    EXPECT_TRUE(std::isnan(sample.amsl_m));
  }
  for (const RouteSample& sample : sample_route(route, 1000, [](GeodeticPoint) { return 30.0; })) {
    EXPECT_EQ(sample.amsl_m, 150);
  }
}

TEST(SampleRoute, MixedLegsMeetAtSeaLevel) {
  const Route route = route_of({at(47, 8, kNone, 100), at(47, 8.1, 700, kNone)});
  EXPECT_THAT(sample_error(route, 100), HasSubstr("give --elevation or --agl-m"));
  const auto samples = sample_route(route, 100, [](GeodeticPoint) { return 400.0; });
  EXPECT_NEAR(samples.front().agl_m, 100, 1e-9);
  EXPECT_NEAR(samples.back().agl_m, 300, 1e-9);
}

TEST(SampleRoute, MissingHeightsAreNamed) {
  EXPECT_THAT(sample_error(route_of({at(47, 8, kNone, kNone), at(47, 8.1, 700, kNone)}), 100,
                           [](GeodeticPoint) { return 0.0; }),
              HasSubstr("there is no height at lat 47.000000, lon 8.000000; give --agl-m"));
}

TEST(SampleRoute, BelowTheGroundIsAnErrorButLandingIsNot) {
  const auto hill = [](GeodeticPoint point) { return std::abs(point.lon_deg - 8.05) < 0.01 ? 634.0 : 400.0; };
  EXPECT_THAT(sample_error(route_of({at(47, 8, 600, kNone), at(47, 8.1, 600, kNone)}), 100, hill),
              HasSubstr("runs 34.0 m below the ground"));
  Route landing = route_of({at(47, 8, 600, kNone), at(47, 8.1, 395, kNone)});
  landing.vertices[1].on_ground = true;
  const auto samples = sample_route(landing, 100, [](GeodeticPoint) { return 400.0; });
  EXPECT_EQ(samples.back().agl_m, 0);
  EXPECT_THAT(sample_error(landing, 100, hill), HasSubstr("below the ground"));
}

TEST(SampleRoute, VerticalClimbsJumpInHeight) {
  const Route route =
      route_of({at(47, 8, kNone, 50), at(47, 8.01, kNone, 50), at(47, 8.01, kNone, 150), at(47, 8.02, kNone, 150)});
  ASSERT_EQ(route.vertices.size(), 4U);
  ASSERT_EQ(route.legs.size(), 2U);
  for (const RouteSample& sample : sample_route(route, 50)) EXPECT_EQ(sample.agl_m, sample.leg == 0 ? 50 : 150);
}

TEST(SampleRoute, StepsAreChecked) {
  const Route route = route_of({at(47, 8, kNone, 50), at(48, 8, kNone, 50)});
  for (const double step : {0.0, -1.0, kNone, HUGE_VAL}) EXPECT_THROW(sample_route(route, step), UsageError) << step;
  EXPECT_THAT(sample_error(route, 1e-6), HasSubstr("samples of the route, at most"));
}

TEST(SampleRoute, WarningsNameLowStretchesAndHome) {
  Route route = route_of({at(47, 8, 430, kNone), at(47, 8.1, 600, kNone)});
  const auto flat = [](GeodeticPoint) { return 415.0; };
  const auto samples = sample_route(route, 100, flat);
  EXPECT_THAT(route_height_warnings(route, samples, flat), SizeIs(1));
  EXPECT_THAT(route_height_warnings(route, samples, flat, 10), IsEmpty());
  route.home = RouteHome{{8, 47}, 0};
  EXPECT_THAT(route_height_warnings(route, samples, flat, 10)[0], HasSubstr("Home is said to lie at 0.0 m"));
  for (RouteVertex& vertex : route.vertices) vertex.agl_m = 80;  // --agl-m: nothing hangs on home's height
  EXPECT_THAT(route_height_warnings(route, sample_route(route, 100, flat), flat, 10), IsEmpty());
}

}  // namespace
}  // namespace pilotage
