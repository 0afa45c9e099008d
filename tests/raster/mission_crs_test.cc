#include "pilotage/raster/mission_crs.h"

#include <cmath>

#include "testing/error_of.h"
#include "testing/grid_convergence.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using Points = std::vector<GeodeticPoint>;

/// Independent of scale_distortion: geodesic and grid lengths of 1 km in eight directions.
double brute_force_distortion(const Crs& crs, const Points& points) {
  const CrsTransform transform(crs);
  double worst = 0;
  for (const GeodeticPoint& point : points) {
    for (int direction = 0; direction < 8; ++direction) {
      const GeodeticPoint a = geodesic_direct(point, 45.0 * direction, -500);
      const GeodeticPoint b = geodesic_direct(point, 45.0 * direction, 500);
      const auto p = transform.map_from_geodetic(a);
      const auto q = transform.map_from_geodetic(b);
      if (!p || !q) return INFINITY;
      worst = std::max(worst, std::abs((*p - *q).norm() / 1000 - 1));
    }
  }
  return worst;
}

void expect_sound(const MissionCrs& chosen, const Points& route, double half_width_m) {
  const Points points = corridor_points(route, half_width_m);
  EXPECT_TRUE(chosen.crs.is_projected());
  EXPECT_EQ(chosen.crs.metres_per_unit(), 1);
  EXPECT_FALSE(chosen.reason.empty());
  EXPECT_LE(chosen.max_scale_distortion, kMaxScaleDistortion);
  EXPECT_NEAR(brute_force_distortion(chosen.crs, points), chosen.max_scale_distortion, 1e-6);
  // Its WKT says all of it, in the dialect of GeoPackage's definition column.
  EXPECT_TRUE(chosen.crs.wkt().starts_with("PROJCS[")) << chosen.crs.wkt();
  const Crs again = Crs::from_user_input(chosen.crs.wkt());
  const CrsTransform first(chosen.crs);
  const CrsTransform second(again);
  for (const GeodeticPoint& point : points) {
    const auto map = first.map_from_geodetic(point);
    ASSERT_TRUE(map);
    EXPECT_LT((*map - *second.map_from_geodetic(point)).norm(), 1e-6);
    const auto back = first.geodetic_from_map(*map);
    ASSERT_TRUE(back);
    EXPECT_LT(geodesic_between(*back, point).length_m, 1e-4);
  }
}

TEST(MissionCrs, KeepsTheZoneAPlannerKnows) {
  const Points route{{114.87, -1.07}, {114.88, -1.08}};  // Kalimantan
  const MissionCrs chosen = choose_mission_crs(route, 500);
  EXPECT_EQ(chosen.crs.authority(), "EPSG:32750");
  EXPECT_THAT(chosen.reason, HasSubstr("UTM zone 50S"));
  expect_sound(chosen, route, 500);
}

TEST(MissionCrs, AUtmZoneEdgeAtTheEquatorIsStillTheZone) {
  // The standard zone's scale at its edge (3° away, on the equator) is 1.00098.
  const Points route{{113.95, 0.01}, {113.99, 0.02}};
  EXPECT_EQ(choose_mission_crs(route, 100).crs.authority(), "EPSG:32649");
}

TEST(MissionCrs, WorksAcrossTheAntimeridian) {
  const Points route{{179.7, -16.5}, {-179.6, -16.9}};  // Fiji
  const MissionCrs chosen = choose_mission_crs(route, 1000);
  // The zone of the middle reaches 0.4° over the antimeridian with a scale of 1.0013: a local projection is better.
  EXPECT_LT(chosen.max_scale_distortion, 1e-4);
  expect_sound(chosen, route, 1000);
  EXPECT_LT(choose_mission_crs({{179.9, -16.5}, {-179.99, -16.6}}, 100).max_scale_distortion, 1e-3);
}

TEST(MissionCrs, WorksAtHighLatitude) {
  const Points svalbard{{15.5, 78.2}, {16.5, 78.3}};
  const MissionCrs chosen = choose_mission_crs(svalbard, 1000);
  EXPECT_EQ(chosen.crs.authority(), "EPSG:32633");  // plain zones: Svalbard's wider ones are not used
  expect_sound(chosen, svalbard, 1000);
}

TEST(MissionCrs, WorksNearAndOverThePole) {
  const Points near{{10, 88}, {-60, 88.3}};
  const MissionCrs chosen = choose_mission_crs(near, 1000);
  EXPECT_THAT(chosen.reason, HasSubstr("UPS north"));  // as what it was compared with: 0.6 % there
  EXPECT_LT(chosen.max_scale_distortion, 1e-3);
  expect_sound(chosen, near, 1000);

  const Points over{{10, 89.5}, {-170, 89.5}};
  expect_sound(choose_mission_crs(over, 1000), over, 1000);
  const Points south{{10, -89.5}, {100, -89.9}, {-170, -89.5}};
  expect_sound(choose_mission_crs(south, 1000), south, 1000);
  const Points ring{{0, 82}, {20, 82.5}};  // where UTM and UPS still overlap in use
  expect_sound(choose_mission_crs(ring, 1000), ring, 1000);
}

TEST(MissionCrs, FollowsALongEastWestRoute) {
  const GeodeticPoint start{10, 55};
  const Points route{start, geodesic_direct(start, 78, 1'500'000)};
  const MissionCrs chosen = choose_mission_crs(route, 5000);
  EXPECT_THAT(chosen.reason, HasSubstr("oblique Mercator"));
  EXPECT_LT(chosen.max_scale_distortion, 1e-4);
  expect_sound(chosen, route, 5000);
}

TEST(MissionCrs, FollowsAParallel) {
  Points route;
  for (int lon = 0; lon <= 24; ++lon) route.push_back({static_cast<double>(lon), 55});
  const MissionCrs chosen = choose_mission_crs(route, 5000);
  EXPECT_THAT(chosen.reason, HasSubstr("Lambert conformal conic on parallel 55"));
  EXPECT_LT(chosen.max_scale_distortion, 1e-4);
  expect_sound(chosen, route, 5000);
}

TEST(MissionCrs, FollowsTheEquatorAndAMeridian) {
  const Points equator{{100, 0}, {113, 0}};
  const MissionCrs along = choose_mission_crs(equator, 5000);
  EXPECT_LT(along.max_scale_distortion, 1e-4);
  expect_sound(along, equator, 5000);

  const Points meridian{{12, 40}, {12, 54}};  // the edge of two zones: 1.0006 … 1.0004 is within the rule
  const MissionCrs up = choose_mission_crs(meridian, 5000);
  EXPECT_LE(up.max_scale_distortion, kStandardZoneDistortion);
  expect_sound(up, meridian, 5000);
}

TEST(MissionCrs, RefusesWhatNoProjectionFits) {
  // 30° by 30°: no conformal map of it stays within 0.5 %.
  const Points square{{0, 0}, {30, 0}, {30, 30}, {0, 30}, {0, 0}};
  try {
    choose_mission_crs(square, 1000);
    FAIL() << "not refused";
  } catch (const DataError& error) {
    EXPECT_THAT(error.what(), HasSubstr("split the route"));
  }
}

TEST(MissionCrs, ChecksWhatTheUserAsksFor) {
  const Points route{{114.87, -1.07}, {114.88, -1.08}};
  EXPECT_EQ(check_mission_crs(Crs::from_user_input("EPSG:32750"), route, 500).crs.authority(), "EPSG:32750");
  const auto crs_error = [](const char* crs, const Points& points) {
    return testing::error_of<UsageError>([&] { check_mission_crs(Crs::from_user_input(crs), points, 500); });
  };
  EXPECT_THAT(crs_error("EPSG:4326", route), HasSubstr("not projected"));
  EXPECT_THAT(crs_error("EPSG:2994", {{-123, 44}}), HasSubstr("0.3048"));
  EXPECT_THAT(crs_error("EPSG:3857", {{15, 45}}), HasSubstr("distorts scale by 41."));  // 1/cos 45° − 1
  EXPECT_THAT(crs_error("EPSG:32633", route), HasSubstr("distorts"));                   // another continent's zone
  // Not even at the equator: its formula is a sphere's, so northwards its scale is 1 / (1 - e^2) there.
  EXPECT_THAT(crs_error("EPSG:3857", {{15, 0}}), HasSubstr("distorts scale by 0.674 %"));
}

TEST(MissionCrs, BadRoutesAreRefused) {
  EXPECT_THROW(choose_mission_crs({}, 100), UsageError);
  EXPECT_THROW(choose_mission_crs({{NAN, 0}}, 100), UsageError);
  EXPECT_THROW(choose_mission_crs({{0, 91}}, 100), UsageError);
  EXPECT_THROW(choose_mission_crs({{0, 0}}, -1), UsageError);
  EXPECT_THROW(choose_mission_crs({{0, 0}}, NAN), UsageError);
}

TEST(MissionCrs, APointIsACorridorToo) {
  const Points points = corridor_points({{10, 50}}, 300);
  for (const GeodeticPoint& point : points)
    EXPECT_LE(geodesic_between({10, 50}, point).length_m, 300 * std::sqrt(2) + 1);
  EXPECT_EQ(choose_mission_crs({{10, 50}}, 300).crs.authority(), "EPSG:32632");
  EXPECT_EQ(choose_mission_crs({{10, 50}, {10, 50}}, 0).crs.authority(), "EPSG:32632");
}

TEST(ScaleDistortion, KnowsTheScaleOfUtm) {
  EXPECT_NEAR(scale_distortion(Crs::from_user_input("EPSG:32633"), {{15, 20}}), 0.0004, 1e-8);
  // 3° from the central meridian on the equator: 0.9996 · (1 + (x/R)²/2 + …) = 1.000981 (Snyder 1987, eq. 8-11).
  EXPECT_NEAR(scale_distortion(Crs::from_user_input("EPSG:32633"), {{18, 0}}), 0.000981, 2e-6);
  // Albers is not conformal: off its standard parallels one direction grows as the other shrinks.
  const Crs albers = Crs::from_user_input("+proj=aea +lat_1=29.5 +lat_2=45.5 +lat_0=23 +lon_0=-96 +datum=WGS84");
  EXPECT_NEAR(scale_distortion(albers, {{-96, 37.5}}), 0.0097, 5e-4);
}

TEST(GridConvergence, IsTheTextbooksNearTheMeridian) {
  const Crs utm = Crs::from_user_input("EPSG:32633");
  EXPECT_NEAR(testing::grid_convergence_deg(utm, {15, 50}), 0, 1e-6);
  // tan γ = tan Δλ sin φ on the sphere; the ellipsoid adds about 1 % of γ's cubic term (Snyder 1987, p. 50).
  const double expected_deg = std::atan(std::tan(2 * M_PI / 180) * std::sin(50 * M_PI / 180)) * 180 / M_PI;
  EXPECT_NEAR(testing::grid_convergence_deg(utm, {17, 50}), expected_deg, 1e-3);
  EXPECT_NEAR(testing::grid_convergence_deg(utm, {13, 50}), -expected_deg, 1e-3);
  // Due north of the pole's stereographic grid, along 90° E, is the grid's west.
  EXPECT_NEAR(testing::grid_convergence_deg(Crs::from_user_input("EPSG:5041"), {90, 85}), 90, 1e-4);
  const Crs gnomonic = Crs::from_user_input("+proj=gnom +lat_0=0 +lon_0=0 +datum=WGS84");
  EXPECT_TRUE(std::isnan(testing::grid_convergence_deg(gnomonic, {180, 0})));
}

TEST(GridConvergence, AnObliqueGridIsNorthUpInItsMiddle) {
  const GeodeticPoint start{0, 30};
  const Points route{start, geodesic_direct(start, 45, 1'000'000)};
  const MissionCrs chosen = choose_mission_crs(route, 1000);
  ASSERT_THAT(chosen.reason, HasSubstr("oblique Mercator"));
  EXPECT_NEAR(testing::grid_convergence_deg(chosen.crs, geodesic_direct(start, 45, 500'000)), 0, 0.05);
}

}  // namespace
}  // namespace pilotage
