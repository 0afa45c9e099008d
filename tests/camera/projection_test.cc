#include "pilotage/camera/projection.h"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "testing/pinhole_camera.h"
#include <gtest/gtest.h>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

const double kInf = std::numeric_limits<double>::infinity();

/// 90° × 90°: at height h the footprint is 2h wide.
Camera square_camera() {
  return testing::pinhole_camera(1000, 1000, 500);
}

TEST(Attitude, AxesPointWhereTheyShould) {
  // Level, heading north: right of the image is east, its top north, the view goes down.
  const Eigen::Matrix3d level = enu_from_camera({}, {});
  EXPECT_LT((level.col(0) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
  EXPECT_LT((level.col(1) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-15);
  EXPECT_LT((level.col(2) - Eigen::Vector3d(0, 0, -1)).norm(), 1e-15);
  // Heading east: the top of the image shows east.
  EXPECT_LT((enu_from_camera({}, {90, 0, 0}).col(1) - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-15);
  // Nose up: the view swings ahead. Right wing down: it swings to the left.
  EXPECT_GT(enu_from_camera({}, {0, 10, 0}).col(2).y(), 0.17);
  EXPECT_LT(enu_from_camera({}, {0, 0, 10}).col(2).x(), -0.17);
  // A mount that looks ahead, on an aircraft that flies east.
  EXPECT_LT((enu_from_camera({0, 90, 0}, {90, 0, 0}).col(2) - Eigen::Vector3d(1, 0, 0)).norm(), 1e-15);
  // Mount yaw turns the top of the image to the right wing.
  EXPECT_LT((enu_from_camera({90, 0, 0}, {}).col(1) - Eigen::Vector3d(-1, 0, 0)).norm(), 1e-15);
}

TEST(Attitude, OrderIsYawThenPitchThenRoll) {
  // Nose of an aircraft heading east and pitched up 30°, whatever its roll.
  const Eigen::Vector3d nose = ned_from_body({90, 30, 50}).col(0);
  EXPECT_LT((nose - Eigen::Vector3d(0, std::cos(std::numbers::pi / 6), -0.5)).norm(), 1e-15);
}

TEST(Projection, KnownPoints) {
  const auto view = make_view(square_camera(), {}, 100);
  ASSERT_TRUE(view);
  EXPECT_LT((*ground_from_pixel(*view, {1000, 0}) - Eigen::Vector2d(100, 100)).norm(), 1e-9);
  EXPECT_LT((*ground_from_pixel(*view, {500, 500}) - Eigen::Vector2d(0, 0)).norm(), 1e-9);
  const auto pitched = make_view(square_camera(), {0, 45, 0}, 100);
  EXPECT_LT((*ground_from_pixel(*pitched, {500, 500}) - Eigen::Vector2d(0, 100)).norm(), 1e-9);
  EXPECT_LT((*ground_from_pixel(*pitched, {500, 1000}) - Eigen::Vector2d(0, 0)).norm(), 1e-9);
  EXPECT_FALSE(ground_from_pixel(*pitched, {500, 0}));  // the horizon
}

TEST(Projection, GroundAndPixelAreInverse) {
  Random random(seed_from_name("GroundAndPixelAreInverse"));
  Camera camera{4000, 2250, 2600, 2610, 2010.5, 1120.25};
  camera.distortion_model = DistortionModel::kBrownConrady;
  camera.distortion = {-0.1, 0.02, 0.001, -0.0005, 0.001};
  camera.mount = {5, 10, -3};
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const Attitude attitude{random.uniform(-180, 180), random.uniform(-40, 40), random.uniform(-40, 40)};
    const auto view = make_view(camera, attitude, random.uniform(1, 3000));
    ASSERT_TRUE(view);
    const Eigen::Vector2d pixel(random.uniform(0, 4000), random.uniform(0, 2250));
    const auto ground = ground_from_pixel(*view, pixel);
    if (!ground) continue;
    const auto again = pixel_from_ground(*view, *ground);
    ASSERT_TRUE(again);
    EXPECT_LT((*again - pixel).norm(), 1e-5);
    ++compared;
  }
  EXPECT_GT(compared, 800);
}

TEST(Projection, SeveralPointsAtOnceAppearWhereEachDoes) {
  Random random(seed_from_name("SeveralPointsAtOnceAppearWhereEachDoes"));
  for (const DistortionModel model :
       {DistortionModel::kNone, DistortionModel::kBrownConrady, DistortionModel::kFisheye}) {
    Camera camera{4000, 2250, 2600, 2610, 2010.5, 1120.25};
    camera.distortion_model = model;
    if (model != DistortionModel::kNone) camera.distortion = {-0.1, 0.02, 0.001, -0.0005, 0.001};
    camera.mount = {5, 10, -3};
    int seen = 0;
    int unseen = 0;
    for (int row = 0; row < 300; ++row) {
      const Attitude attitude{random.uniform(-180, 180), random.uniform(-60, 60), random.uniform(-60, 60)};
      const auto view = make_view(camera, attitude, random.uniform(1, 3000));
      ASSERT_TRUE(view);
      std::array<double, kPointsTogether> east_m{};
      for (double& east : east_m) east = view->agl_m * random.uniform(-8, 8);
      const double north_m = view->agl_m * random.uniform(-8, 8);
      const PixelsTogether pixels = pixels_from_ground(*view, east_m, north_m);
      for (std::size_t i = 0; i < kPointsTogether; ++i) {
        const auto pixel = pixel_from_ground(*view, {east_m[i], north_m});
        ASSERT_EQ(pixels.seen[i], pixel.has_value()) << east_m[i] << " " << north_m;
        ++(pixel ? seen : unseen);
        if (!pixel) continue;
        EXPECT_NEAR(pixels.x_px[i], pixel->x(), 1e-9 * (1 + std::abs(pixel->x())));
        EXPECT_NEAR(pixels.y_px[i], pixel->y(), 1e-9 * (1 + std::abs(pixel->y())));
      }
    }
    EXPECT_GT(seen, 200);
    EXPECT_GT(unseen, 200);
  }
}

TEST(Footprint, LevelFrame) {
  const Footprint level = footprint(square_camera(), {30, 0, 0}, 120);
  EXPECT_NEAR(level.area_m2, 240 * 240, 1e-6);
  EXPECT_NEAR(level.across_m, 240, 1e-9);
  EXPECT_NEAR(level.along_m, 240, 1e-9);
  EXPECT_NEAR(level.inscribed_radius_m, 120, 1e-9);
  EXPECT_LT(level.center_m.norm(), 1e-9);
  EXPECT_FALSE(level.cut);
}

TEST(Footprint, TiltedFrameIsATrapezium) {
  // 20° forward: near edge at tan(−25°), far edge at tan(65°) of the height; half widths 1/cos of the edge's angle ×
  // cos 45°.
  const Footprint tilted = footprint(square_camera(), {0, 20, 0}, 100);
  const auto tan_deg = [](double angle_deg) { return std::tan(angle_deg * std::numbers::pi / 180); };
  const auto half_width = [](double angle_deg) {
    return 100 * std::cos(std::numbers::pi / 4) / std::cos(angle_deg * std::numbers::pi / 180);
  };
  const double depth = 100 * (tan_deg(65) + tan_deg(25));
  EXPECT_NEAR(tilted.along_m, depth, 1e-9);
  EXPECT_NEAR(tilted.area_m2, depth * (half_width(65) + half_width(25)), 1e-6);
  EXPECT_GT(tilted.center_m.y(), 0);
  EXPECT_NEAR(tilted.center_m.x(), 0, 1e-9);
}

TEST(Footprint, HorizonCutsIt) {
  const Footprint ahead = footprint(square_camera(), {0, 90, 0}, 100);
  EXPECT_TRUE(ahead.cut);
  ASSERT_FALSE(ahead.polygon_m.empty());
  double farthest = 0;
  for (const auto& point : ahead.polygon_m) {
    farthest = std::max(farthest, point.norm());
    EXPECT_GT(point.y(), 99);  // nothing is seen nearer than 45° below the horizon
  }
  const double limit = 100 * std::tan(80 * std::numbers::pi / 180);
  EXPECT_LE(farthest, limit);
  EXPECT_GT(farthest, 0.99 * limit);

  EXPECT_TRUE(footprint(square_camera(), {0, 180, 0}, 100).polygon_m.empty());  // looks up
}

TEST(Footprint, NothingForBadInput) {
  for (const double bad : {kNaN, kInf, -kInf}) {
    EXPECT_TRUE(footprint(square_camera(), {bad, 0, 0}, 100).polygon_m.empty());
    EXPECT_TRUE(footprint(square_camera(), {0, bad, 0}, 100).polygon_m.empty());
    EXPECT_TRUE(footprint(square_camera(), {0, 0, bad}, 100).polygon_m.empty());
    EXPECT_TRUE(footprint(square_camera(), {}, bad).polygon_m.empty());
  }
  EXPECT_TRUE(footprint(square_camera(), {}, 0).polygon_m.empty());
  EXPECT_TRUE(footprint(Camera{}, {}, 100).polygon_m.empty());
}

TEST(Gsd, AtTheCentre) {
  const auto gsd = gsd_m({1000, 1000, 500, 400, 500, 500}, 100);
  EXPECT_DOUBLE_EQ(gsd.across_m, 0.2);
  EXPECT_DOUBLE_EQ(gsd.along_m, 0.25);
}

}  // namespace
}  // namespace pilotage
