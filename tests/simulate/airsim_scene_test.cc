#include "pilotage/simulate/airsim_scene.h"

#include "airsim/serving.h"
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/airsim/airsim_client.h"
#include "pilotage/raster/gray_source.h"

namespace pilotage {
namespace {

const GeodeticPoint kSceneStart{15, 45.14};

/// Ground in UTM 33 whose middle is the start of the route.
RenderedWorld striped_world() {
  Raster raster{cv::Mat(600, 600, CV_8UC1), cv::Mat(600, 600, CV_8UC1, cv::Scalar(255)), {}};
  for (int row = 0; row < 600; ++row) {
    for (int col = 0; col < 600; ++col) {
      raster.pixels.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>((row * row / 50 + col * row / 90) % 256);
    }
  }
  RenderedWorld world;
  const Crs utm = Crs::from_user_input("EPSG:32633");
  const Eigen::Vector2d middle = *CrsTransform(utm).map_from_geodetic(kSceneStart);
  raster.map_from_pixel = GeoTransform::north_up(middle.x() - 150, middle.y() + 150, 0.5);
  world.ground = gray_source_from(raster);
  world.ground.crs = utm;
  return world;
}

Mission mission_from_start() {
  Mission mission;
  FlightSample start;
  start.point = kSceneStart;
  mission.flight.samples = {start};
  return mission;
}

TEST(AirsimScene, ClientsGetTheFramesOfTheWorld) {
  const RenderedWorld world = striped_world();
  Camera camera{80, 60, 70, 70, 40, 30};
  camera.mount = {90, 10, 0};
  const WorldCamera direct(world, camera);
  for (const AirsimDialect dialect : {AirsimDialect::kAirsim, AirsimDialect::kColosseum, AirsimDialect::kCosys}) {
    AirsimSimulation simulation(dialect, airsim_scene(mission_from_start(), world, camera));
    const testing::Served server(simulation.service());
    AirsimClient client(server.address());
    EXPECT_EQ(client.home().longitude, kSceneStart.lon_deg);

    const Attitude attitude{30, 2, -3};
    const AirsimPose pose{airsim_vector({20, -15, -70}), quaternion_of(ned_from_body(attitude))};
    client.set_pose(pose);
    const cv::Mat seen = client.image("bottom_center");
    // At the pose as it is in float32 the same bytes.
    CameraPose there;
    there.position = place_from_ned({kSceneStart, 0}, vector_of(pose.position)).point;
    there.height_agl_m = 70;
    there.attitude = attitude_of_camera(rotation_of(pose.orientation) * airsim_camera_rotation(camera.mount));
    Camera unmounted = camera;
    unmounted.mount = {};
    cv::Mat expected;
    cv::cvtColor(WorldCamera(world, unmounted).frame_at(there).gray, expected, cv::COLOR_GRAY2BGR);
    EXPECT_EQ(cv::norm(seen, expected, cv::NORM_INF), 0);
    EXPECT_GT(cv::mean(seen)[0], 50);
    // At the exact pose, by attitude and mount, all but the same.
    there.attitude = attitude;
    cv::cvtColor(direct.frame_at(there).gray, expected, cv::COLOR_GRAY2BGR);
    EXPECT_LE(cv::norm(seen, expected, cv::NORM_INF), 1);
  }
}

TEST(AirsimScene, IsDrawnFromTheGroundAtLeast) {
  const RenderedWorld world = striped_world();
  const Camera camera{80, 60, 70, 70, 40, 30};
  const AirsimScene scene = airsim_scene(mission_from_start(), world, camera);
  AirsimView view{camera, {kSceneStart, 0}, {}};
  const cv::Mat on_ground = scene.frame(view);
  EXPECT_GT(cv::mean(on_ground)[0], 0);
  view.place.altitude_m = -50;
  EXPECT_EQ(cv::norm(scene.frame(view), on_ground, cv::NORM_INF), 0);
  view.place.altitude_m = 60;
  EXPECT_NE(cv::norm(scene.frame(view), on_ground, cv::NORM_INF), 0);
  view.camera.fx_px = view.camera.fy_px = 140;  // another field of view
  Camera narrow = camera;
  narrow.fx_px = narrow.fy_px = 140;
  const cv::Mat expected = WorldCamera(world, narrow).frame_at({kSceneStart, 60, kNaN, {}}).gray;
  EXPECT_EQ(cv::norm(scene.frame(view), expected, cv::NORM_INF), 0);
}

}  // namespace
}  // namespace pilotage
