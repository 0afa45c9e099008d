#include "pilotage/route/mission_curve.h"

#include <cmath>
#include <string>

#include "route/route_files.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

constexpr GeodeticPoint kStart{8, 47};

GeodeticPoint offset(GeodeticPoint from, double east_m, double north_m) {
  return geodesic_direct(from, std::atan2(east_m, north_m) * 180 / M_PI, std::hypot(east_m, north_m));
}

// Independent of the code: the Hermite basis at a time.
GroundVector hermite(double t, GroundVector to, GroundVector leaving, GroundVector arriving) {
  const double h01 = t * t * (3 - 2 * t);
  const double h10 = t * (1 - t) * (1 - t);
  const double h11 = -t * t * (1 - t);
  return {h01 * to.east_m + h10 * leaving.east_m + h11 * arriving.east_m,
          h01 * to.north_m + h10 * leaving.north_m + h11 * arriving.north_m};
}

TEST(MissionCurve, ChordsStayNearTheHermiteCurve) {
  const GroundVector to{0, 200};
  const GroundVector leaving{150, 100};
  const GroundVector arriving{250, 0};
  double departure_m = 0;
  const auto points = spline_points(kStart, offset(kStart, 0, 200), leaving, arriving, &departure_m);
  ASSERT_GE(points.size(), 4U);
  std::vector<GroundVector> chords = {{0, 0}};
  for (const CurvePoint& point : points) chords.push_back(ground_vector(kStart, point.point));
  chords.push_back(to);
  double farthest_m = 0;
  double widest_m = 0;
  for (int i = 0; i <= 1000; ++i) {
    const GroundVector at = hermite(i / 1000.0, to, leaving, arriving);
    double nearest_m = INFINITY;
    for (std::size_t k = 1; k < chords.size(); ++k) {
      const double dx = chords[k].east_m - chords[k - 1].east_m;
      const double dy = chords[k].north_m - chords[k - 1].north_m;
      const double px = at.east_m - chords[k - 1].east_m;
      const double py = at.north_m - chords[k - 1].north_m;
      const double f = std::min(1.0, std::max(0.0, (px * dx + py * dy) / (dx * dx + dy * dy)));
      nearest_m = std::min(nearest_m, std::hypot(px - f * dx, py - f * dy));
    }
    farthest_m = std::max(farthest_m, nearest_m);
    widest_m = std::max(widest_m, std::abs(at.east_m));
  }
  EXPECT_LE(farthest_m, kChordError_m + 1e-6);
  EXPECT_NEAR(departure_m, widest_m, kChordError_m);
  EXPECT_GT(points[1].fraction, points[0].fraction);
  EXPECT_LT(points.back().fraction, 1);
}

TEST(MissionCurve, LongEndVectorsAreShortened) {
  double departure_m = 0;
  const GeodeticPoint to = offset(kStart, 0, 100);
  const auto limited = spline_points(kStart, to, {4000, 0}, {4000, 0}, &departure_m);
  double same_m = 0;
  const auto expected = spline_points(kStart, to, {200, 0}, {200, 0}, &same_m);  // together 4 x 100 m
  EXPECT_NEAR(departure_m, same_m, 1e-9);
  EXPECT_EQ(limited.size(), expected.size());
}

TEST(MissionCurve, StraightOnHasNoPoints) {
  double departure_m = 1;
  EXPECT_TRUE(spline_points(kStart, offset(kStart, 0, 100), {0, 80}, {0, 120}, &departure_m).empty());
  EXPECT_TRUE(spline_points(kStart, offset(kStart, 0, 100), {}, {}, &departure_m).empty());
  EXPECT_TRUE(spline_points(kStart, kStart, {0, 80}, {0, 120}, &departure_m).empty());
}

TEST(MissionCurve, CirclesKeepTheirRadiusAndSense) {
  for (const double radius_m : {1.0, 50.0, 2000.0}) {
    const auto points = circle_points(kStart, radius_m, 30, true);
    ASSERT_GE(points.size(), 8U);
    for (const GeodeticPoint point : points) EXPECT_NEAR(geodesic_between(kStart, point).length_m, radius_m, 1e-6);
    const double chord_m = geodesic_between(points[0], points[1]).length_m;
    const double sagitta_m = radius_m - std::sqrt(radius_m * radius_m - chord_m * chord_m / 4);
    EXPECT_LE(sagitta_m, kChordError_m + 1e-6) << radius_m;
    EXPECT_NEAR(geodesic_between(kStart, points[0]).start_azimuth_deg, 30, 1e-6);
    EXPECT_GT(geodesic_between(kStart, points[1]).start_azimuth_deg, 30);
  }
  const auto back = circle_points(kStart, 50, 30, false);
  EXPECT_LT(geodesic_between(kStart, back[1]).start_azimuth_deg, 30);
}

const std::string kCurveHead =
    "QGC WPL 110\n0 1 0 16 0 0 0 0 47 8 400 1\n1 0 3 22 0 0 0 0 0 0 100 1\n2 0 3 16 0 0 0 0 47.002 8 100 1\n";

// Waypoint north, spline to the north-east, spline on to the north: the first leaves with the vector of the straight
// leg, and each arrives parallel to the line from its start to the place after it.
TEST(MissionCurve, SplineWaypointsAreFlownAsCurves) {
  const Route route =
      parse_route("r", kCurveHead + "3 0 3 82 0 0 0 0 47.004 8.004 110 1\n4 0 3 82 0 0 0 0 47.006 8.004 120 1\n");
  ASSERT_GT(route.vertices.size(), 8U);
  EXPECT_EQ(route.vertices[2].kind, "spline waypoint");
  const RouteLeg& first = route.legs[1];
  const GeodesicLeg start = geodesic_between(route.vertices[static_cast<std::size_t>(first.from)].point,
                                             route.vertices[static_cast<std::size_t>(first.to)].point);
  EXPECT_NEAR(start.start_azimuth_deg, 0, 15) << "leaves to the north";
  double highest_m = 0;
  for (std::size_t i = 1; i < route.vertices.size(); ++i) {
    EXPECT_GE(route.vertices[i].amsl_m, route.vertices[i - 1].amsl_m - 1e-9);
    highest_m = std::max(highest_m, route.vertices[i].amsl_m);
  }
  EXPECT_EQ(highest_m, 520);
  EXPECT_THAT(route.notes, Contains(HasSubstr("Spline waypoints are flown as ArduCopter does")));
  EXPECT_THAT(route.items[3].became, HasSubstr("spline, "));
  for (std::size_t i = 1; i < route.legs.size(); ++i) EXPECT_EQ(route.legs[i].from, route.legs[i - 1].to);
}

TEST(MissionCurve, LoitersWithARadiusAreCircles) {
  const Route route =
      parse_route("r", kCurveHead + "3 0 3 18 2 0 -50 0 47.004 8 100 1\n4 0 3 16 0 0 0 0 47.006 8 100 1\n");
  const double straight_m = geodesic_between({8, 47}, {8, 47.006}).length_m;
  // To the circle, once around, and on from where it was entered.
  EXPECT_NEAR(route_length_m(route), straight_m + 2 * M_PI * 50, 5);
  EXPECT_THAT(route.items[3].became, HasSubstr("circle of radius 50 m"));
  EXPECT_THAT(route.notes, Contains(HasSubstr("Circles of loiters stand once")));
  const Route none = parse_route("r", kCurveHead + "3 0 3 18 2 0 0 0 47.004 8 100 1\n");
  EXPECT_THAT(none.notes, Contains(HasSubstr("Item 3 (loiter turns) names no radius")));
  EXPECT_THAT(testing::route_error(kCurveHead + "3 0 3 18 2 0 25000 0 47.004 8 100 1\n"),
              HasSubstr("its radius, 25000 m"));
}

TEST(MissionCurve, RealMissionHasBoth) {
  const std::filesystem::path data = testing::real_data_folder();
  const std::filesystem::path file = data / "routes" / "drones" / "spline.waypoints";
  if (data.empty() || !std::filesystem::exists(file)) GTEST_SKIP() << testing::kNoRealImagery;
  const Route route = read_route(file);
  EXPECT_GT(route.vertices.size(), 20U);
  EXPECT_THAT(route.notes, Contains(HasSubstr("Spline waypoints are flown as ArduCopter does")));
  EXPECT_THAT(route.notes, Contains(HasSubstr("Circles of loiters stand once")));
}

}  // namespace
}  // namespace pilotage
