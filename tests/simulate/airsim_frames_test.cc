#include "pilotage/simulate/airsim_frames.h"

#include <cmath>

#include "airsim/serving.h"
#include "testing/error_of.h"
#include "testing/textured_map.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/parallel.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/simulate/airsim_scene.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

/// Textured ground, seen by the renderer and served to clients.
struct ServedGround {
  testing::TexturedGround ground = testing::make_textured_ground(5);
  RenderedWorld world;
  Mission mission;
  AirsimSimulation simulation;
  testing::Served server;

  explicit ServedGround(AirsimDialect dialect)
      : world{ground.gray, "", false},
        mission(start_over(ground)),
        simulation(dialect, airsim_scene(mission, with_crs(world, ground), ground.camera)),
        server(simulation.service()) {}

  static Mission start_over(const testing::TexturedGround& ground) {
    Mission mission;
    FlightSample start;
    start.point = ground.center;
    mission.flight.samples = {start};
    return mission;
  }
  static const RenderedWorld& with_crs(RenderedWorld& world, const testing::TexturedGround& ground) {
    world.ground.crs = ground.crs;
    return world;
  }
  AirsimFrameOptions options() const {
    AirsimFrameOptions options;
    options.airsim = server.address().text();
    return options;
  }
  CameraPose pose(double east_m) const {
    CameraPose pose;
    pose.position = LocalFrame(ground.center).geodetic_from_enu({east_m, -7, 0});
    pose.height_agl_m = ground.agl_m;
    pose.attitude = {340 + east_m, 2, -1.5};
    return pose;
  }
};

/// What float32 poses change of a frame: a gray level here and there.
void expect_almost_same(const RenderedFrame& seen, const RenderedFrame& drawn) {
  EXPECT_EQ(drawn.valid_fraction, 1);
  EXPECT_GT(seen.valid_fraction, 0.99);
  EXPECT_LE(cv::norm(seen.gray, drawn.gray, cv::NORM_INF), 1);
  EXPECT_LT(cv::norm(seen.gray, drawn.gray, cv::NORM_L1) / static_cast<double>(drawn.gray.total()), 0.01);
}

TEST(AirsimFrames, AreThoseOfTheRendererInAllDialects) {
  for (const AirsimDialect dialect : {AirsimDialect::kAirsim, AirsimDialect::kColosseum, AirsimDialect::kCosys}) {
    const ServedGround served(dialect);
    const FrameSource by_server = airsim_frames(served.mission, served.ground.camera, served.options());
    const FrameSource by_renderer = rendered_frames(served.world, served.ground.camera);
    EXPECT_EQ(by_server.camera, served.ground.camera);
    EXPECT_FALSE(by_server.of_the_map);
    const FrameTaker taker = by_server.open();
    expect_almost_same(taker.frame_at(served.pose(3)), by_renderer.open().frame_at(served.pose(3)));
    EXPECT_TRUE(std::isnan(taker.ground_amsl_m(served.ground.center)));
  }
}

TEST(AirsimFrames, EachThreadSeesFromItsOwnPose) {
  const ServedGround served(AirsimDialect::kAirsim);
  const FrameSource frames = airsim_frames(served.mission, served.ground.camera, served.options());
  const FrameTaker renderer = rendered_frames(served.world, served.ground.camera).open();
  std::vector<RenderedFrame> seen(12);
  parallel_for(seen.size(), 4, [&](std::size_t i, int /*worker*/) {
    seen[i] = frames.open().frame_at(served.pose(static_cast<double>(i)));
  });
  for (std::size_t i = 0; i < seen.size(); ++i) {
    expect_almost_same(seen[i], renderer.frame_at(served.pose(static_cast<double>(i))));
  }
}

TEST(AirsimFrames, RefuseCamerasThatAirsimHasNot) {
  const ServedGround served(AirsimDialect::kAirsim);
  const auto refused = [&](const Camera& camera) {
    return testing::error_of<DataError>([&] { airsim_frames(served.mission, camera, served.options()); });
  };
  Camera camera = served.ground.camera;
  camera.distortion_model = DistortionModel::kFisheye;
  EXPECT_THAT(refused(camera), HasSubstr("AirSim's cameras have none of them"));
  camera = served.ground.camera;
  camera.cx_px += 5;
  EXPECT_THAT(refused(camera), HasSubstr("a principal point beside the middle"));
  camera = served.ground.camera;
  camera.height_px *= 2;  // the server's pictures keep their shape
  camera.cy_px *= 2;
  EXPECT_THAT(refused(camera), HasSubstr("bottom_center"));
  AirsimFrameOptions other = served.options();
  other.airsim_camera = "belly";
  EXPECT_THAT(testing::error_of<DataError>([&] { airsim_frames(served.mission, served.ground.camera, other); }),
              HasSubstr("there is no camera \"belly\""));
}

}  // namespace
}  // namespace pilotage
