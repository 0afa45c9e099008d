#include "pilotage/report/seen_frames.h"

#include <cmath>

#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

constexpr double kAgl_m = 50;

// 400 × 400 m of ground that becomes lighter to the north, and a flight over its middle.
struct Scene {
  testing::TemporaryFolder folder;
  Mission mission;

  explicit Scene(double azimuth_deg, int samples = 200) {
    testing::RasterSpec spec;
    spec.width = spec.height = 400;
    spec.value = [](int, int, int row) { return 240 - row / 2; };
    mission.ground.crs = Crs::from_user_input("EPSG:32633");
    mission.ground.imagery.datasets.push_back(
        {testing::make_raster(folder / "a.tif", spec), 1, "EPSG:32633", "", spec.width, spec.height});
    GridLevel level;
    level.gsd_m = std::abs(spec.place.x_per_col);
    level.matrix = {0, spec.place, spec.width, spec.height, 40, 20};
    mission.ground.levels.push_back(level);
    Camera& camera = mission.flight.camera;
    camera.width_px = 1600;
    camera.height_px = 1200;
    camera.fx_px = camera.fy_px = 1600;
    camera.cx_px = 800;
    camera.cy_px = 600;
    const Eigen::Vector2d middle = spec.place.map_from_pixel(Eigen::Vector2d(200, 200));
    for (int i = 0; i < samples; ++i) {
      FlightSample& sample = mission.flight.samples.emplace_back();
      sample.distance_m = i;
      sample.azimuth_deg = azimuth_deg;
      sample.agl_m = kAgl_m;
      sample.point_map_m = middle;
      sample.level = 0;
    }
  }

  SeenFrames rendered(int threads = 1) const { return render_seen_frames(mission, open_own_imagery(mission), threads); }
};

double mean_gray(const SeenFrames& seen, std::size_t i, int from_row, int to_row) {
  return cv::mean(seen.sheet(seen.place(i)).rowRange(from_row, to_row))[0];
}

TEST(SeenFrames, TheDirectionOfFlightIsUp) {
  for (const auto& [azimuth_deg, ahead_is_lighter] : {std::pair(0.0, true), std::pair(180.0, false)}) {
    const SeenFrames seen = Scene(azimuth_deg).rendered();
    ASSERT_EQ(seen.frames.size(), kMostSeenFrames);
    EXPECT_EQ(seen.width_px, kSeenFrameSide_px);
    EXPECT_EQ(seen.height_px, 144);
    EXPECT_EQ(seen.sheet.type(), CV_8UC1);
    const double ahead = mean_gray(seen, 7, 0, 10);
    const double behind = mean_gray(seen, 7, 134, 144);
    EXPECT_GT(std::abs(ahead - behind), 5) << azimuth_deg;
    EXPECT_EQ(ahead > behind, ahead_is_lighter) << azimuth_deg;
    EXPECT_NEAR(mean_gray(seen, 7, 71, 73), 140, 2) << "below the aircraft";
  }
}

TEST(SeenFrames, StandInTheMiddlesOfEqualStretches) {
  const Scene scene(90);
  const SeenFrames seen = scene.rendered();
  for (std::size_t i = 0; i < seen.frames.size(); ++i) {
    const SeenFrame& frame = seen.frames[i];
    EXPECT_NEAR(frame.distance_m, 199 * (static_cast<double>(i) + 0.5) / kMostSeenFrames, 0.51);
    EXPECT_EQ(frame.azimuth_deg, 90);
    EXPECT_NEAR(frame.width_m, kAgl_m, 1e-9);
    EXPECT_FALSE(frame.tile) << "the ground has no tile";
    const cv::Rect place = seen.place(i);
    EXPECT_TRUE((place & cv::Rect({0, 0}, seen.sheet.size())) == place);
  }
  EXPECT_EQ(cv::norm(seen.sheet, scene.rendered(4).sheet, cv::NORM_INF), 0) << "differs between 1 and 4 threads";
}

TEST(SeenFrames, OnceForEachPlaceAndNoneTooLow) {
  Scene scene(0, 3);
  EXPECT_EQ(scene.rendered().frames.size(), 3U) << "a short route is not looked at twice in one place";
  for (FlightSample& sample : scene.mission.flight.samples) sample.level = FlightSample::kNoLevel;
  EXPECT_TRUE(scene.rendered().frames.empty());
  EXPECT_TRUE(render_seen_frames(Mission{}, {}).frames.empty());
}

TEST(SeenFrames, WhatIsOutsideTheImageryIsGray) {
  Scene scene(0, 1);
  scene.mission.flight.samples[0].point_map_m.x() += 1e5;
  const SeenFrames seen = scene.rendered();
  ASSERT_EQ(seen.frames.size(), 1U);
  EXPECT_EQ(mean_gray(seen, 0, 0, 144), 192);
}

TEST(SeenFrames, StopWhenAskedTo) {
  const Scene scene(0);
  EXPECT_THROW(render_seen_frames(scene.mission, open_own_imagery(scene.mission), 2,
                                  [](std::string_view, std::int64_t, std::int64_t) { return false; }),
               Interrupted);
}

}  // namespace
}  // namespace pilotage
