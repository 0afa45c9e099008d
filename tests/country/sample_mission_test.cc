// The committed files of maps/sample against the scene they are flown over.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "testing/source_folder.h"
#include <GeographicLib/UTMUPS.hpp>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "country/synthetic_scene.h"
#include "pilotage/base/options_json.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

std::string sample_file(const std::string& name) {
  return read_file(testing::source_folder() / ("maps/sample/" + name));
}

struct Flown {
  Vector2d local_m;
  double relative_m = 0;
};

Vector2d local_from_geodetic(const Scene& scene, double lat_deg, double lon_deg) {
  int zone = 0;
  bool north = true;
  double easting_m = 0;
  double northing_m = 0;
  GeographicLib::UTMUPS::Forward(lat_deg, lon_deg, zone, north, easting_m, northing_m);
  EXPECT_EQ((north ? 32600 : 32700) + zone, scene.epsg);
  return Vector2d(easting_m, northing_m) - scene.origin_m;
}

double ground_m(const Scene& scene, const Vector2d& local_m) {
  const Vector2d p = scene.map_from_local(local_m);
  return elevation(scene, GeoTransform::north_up(p.x() - 0.5, p.y() + 0.5, 1), 1, 1).at<float>(0, 0);
}

/// Takeoff and waypoints of the plan, all relative to home (frame 3).
std::vector<Flown> flown_points(const Scene& scene, const nlohmann::ordered_json& plan) {
  std::vector<Flown> points;
  for (const auto& item : plan.at("mission").at("items")) {
    const int command = item.at("command").get<int>();
    if (command != 16 && command != 22) continue;
    EXPECT_EQ(item.at("frame").get<int>(), 3);
    const auto& params = item.at("params");
    points.push_back({local_from_geodetic(scene, params.at(4).get<double>(), params.at(5).get<double>()),
                      params.at(6).get<double>()});
  }
  return points;
}

TEST(SampleMission, TheRouteFliesOverItsImageryAtItsHeight) {
  const Scene scene = make_scene({});
  const auto plan = parse_json("route.plan", sample_file("route.plan"));
  const std::vector<Flown> points = flown_points(scene, plan);
  ASSERT_GE(points.size(), 9U);
  const auto& home = plan.at("mission").at("plannedHomePosition");
  const Vector2d home_m = local_from_geodetic(scene, home.at(0).get<double>(), home.at(1).get<double>());
  EXPECT_NEAR(home.at(2).get<double>(), ground_m(scene, home_m), 0.3);
  double length_m = (points.front().local_m - home_m).norm() + (points.back().local_m - home_m).norm();
  double longest_water_m = 0;
  double water_m = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const Vector2d leg = points[i].local_m - points[i - 1].local_m;
    length_m += leg.norm();
    for (double along = 0; along < leg.norm(); along += 5) {
      const double share = along / leg.norm();
      const Vector2d p = points[i - 1].local_m + share * leg;
      ASSERT_GE(p.x(), 150);
      ASSERT_GE(p.y(), 150);
      ASSERT_LE(p.x(), scene.options.width_m - 150);
      ASSERT_LE(p.y(), scene.options.height_m - 150);
      const double agl_m = points[i - 1].relative_m + share * (points[i].relative_m - points[i - 1].relative_m) +
                           home.at(2).get<double>() - ground_m(scene, p);
      EXPECT_GT(agl_m, 95) << p.transpose();
      EXPECT_LT(agl_m, 145) << p.transpose();
      const Vector2d map = scene.map_from_local(p);
      const bool water =
          land_cover(scene, SceneEpoch::kFirst, GeoTransform::north_up(map.x() - 0.5, map.y() + 0.5, 1), 1, 1, 1)
              .at<unsigned char>(0, 0) == static_cast<int>(LandCover::kWater);
      water_m = water ? water_m + 5 : 0;
      longest_water_m = std::max(longest_water_m, water_m);
    }
  }
  EXPECT_GT(length_m, 6000);
  EXPECT_LT(length_m, 8000);
  // Long enough for a real gap, whatever the footprint on its shores shows.
  EXPECT_GT(longest_water_m, 600);
}

TEST(SampleMission, TheMissionNamesFilesThatAreThere) {
  const auto mission = parse_json("mission.json", sample_file("mission.json"));
  EXPECT_EQ(mission.at("imagery").at(0), "ortho.tif");
  EXPECT_EQ(mission.at("elevation"), "elevation.tif");
  EXPECT_NO_THROW(parse_json("route.plan", sample_file(mission.at("route").get<std::string>())));
  EXPECT_FALSE(sample_file(mission.at("camera").at("file").get<std::string>()).empty());
}

}  // namespace
}  // namespace pilotage
