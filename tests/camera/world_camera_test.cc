#include "pilotage/camera/world_camera.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

const Camera kWorldCamera{80, 60, 70, 70, 40, 30};

/// Random blotches, half a metre a pixel in UTM 33.
RenderedWorld blotchy_world() {
  RenderedWorld world;
  Raster raster{cv::Mat(600, 600, CV_8UC1), cv::Mat(600, 600, CV_8UC1, cv::Scalar(255)), {}};
  Random random(seed_from_name("blotchy_world"));
  for (int row = 0; row < 600; ++row) {
    for (int col = 0; col < 600; ++col) {
      raster.pixels.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>(random.below(256));
    }
  }
  cv::GaussianBlur(raster.pixels, raster.pixels, {}, 2);
  raster.map_from_pixel = GeoTransform::north_up(500000, 5'000'000, 0.5);
  world.ground = gray_source_from(raster);
  world.ground.crs = Crs::from_user_input("EPSG:32633");
  return world;
}

TEST(WorldCamera, AFrameIsTheGroundBelowThePose) {
  const RenderedWorld world = blotchy_world();
  const WorldCamera camera(world, kWorldCamera);
  const CrsTransform utm(world.ground.crs);
  // Over the corner of pixels (300, 200): 70 m up, a pixel of the frame is 1 m, two of the ground.
  const CameraPose pose{*utm.geodetic_from_map({500150, 4'999'900}), 70, kNaN, {0, 0, 0}};
  const RenderedFrame frame = camera.frame_at(pose);
  ASSERT_EQ(frame.valid_fraction, 1);
  cv::Mat expected;
  cv::resize(world.ground.read({300 - 80, 200 - 60, 160, 120}).pixels, expected, {80, 60}, 0, 0, cv::INTER_AREA);
  EXPECT_LT(cv::norm(frame.gray, expected, cv::NORM_L1) / 4800, 1.0);  // grays vary by some 20
  // Facing east the picture is turned: its top shows the east.
  CameraPose east = pose;
  east.attitude.yaw_deg = 90;
  cv::Mat square;
  cv::rotate(frame.gray.colRange(10, 70), square, cv::ROTATE_90_COUNTERCLOCKWISE);
  EXPECT_LT(cv::norm(camera.frame_at(east).gray.colRange(10, 70), square, cv::NORM_L1) / 3600, 1.0);
  EXPECT_EQ(WorldCamera(world, kWorldCamera).frame_at(pose).gray.size(), cv::Size(80, 60));
  EXPECT_EQ(cv::norm(WorldCamera(world, kWorldCamera).frame_at(pose).gray, frame.gray, cv::NORM_INF), 0);
}

TEST(WorldCamera, NothingIsSeenOutsideItAndPosesThatAreNoneAreRefused) {
  const RenderedWorld world = blotchy_world();
  const WorldCamera camera(world, kWorldCamera);
  EXPECT_EQ(camera.frame_at({{10, 40}, 70, kNaN, {}}).valid_fraction, 0);
  EXPECT_THROW(camera.frame_at({{15, 45.14}, 0, kNaN, {}}), UsageError);
  EXPECT_TRUE(std::isnan(camera.ground_amsl_m({15, 45})));
}

}  // namespace
}  // namespace pilotage
