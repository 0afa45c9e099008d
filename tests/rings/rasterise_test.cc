#include "rasterise.h"

#include <cmath>
#include <numbers>

#include "rings/ring_views.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/camera/projection.h"

namespace pilotage {
namespace {

using testing::gray_ground;
using testing::looking;

constexpr Paint kRed = {200, 0, 0};

CameraPose straight_down(double height_m) {
  return {{0, 0, height_m}, enu_from_camera({}, {})};
}

int red_pixels(const cv::Mat& rgb) {
  cv::Mat mask;
  cv::inRange(rgb, cv::Scalar(60, 0, 0), cv::Scalar(255, 60, 255), mask);  // half of the ground's green
  return cv::countNonZero(mask);
}

// The picture's colors say where its ground is: red east, green north.
TEST(Rasterise, GroundIsWhereTheProjectionPutsIt) {
  cv::Mat picture(400, 400, CV_8UC3);
  for (int row = 0; row < 400; ++row) {
    for (int col = 0; col < 400; ++col) {
      picture.at<cv::Vec3b>(row, col) = cv::Vec3b(static_cast<uchar>(col / 2), static_cast<uchar>(row / 2), 0);
    }
  }
  Eigen::Matrix2d pixel_from_enu_m;
  pixel_from_enu_m << 10, 0, 0, -10;
  const GroundPicture ground = make_ground_picture(picture, {200, 200}, pixel_from_enu_m);
  Camera camera{160, 120, 140, 140, 80, 60};
  camera.mount.pitch_deg = 25;
  const Attitude attitude{30, 4, -6};
  const RasterisedFrame frame = rasterise({}, ground, camera, {{2, -3, 9}, enu_from_camera(camera.mount, attitude)});
  const View view = make_view(camera, attitude, 9).value();
  for (const Eigen::Vector2d& pixel : {Eigen::Vector2d(10.5, 100.5), {80.5, 60.5}, {150.5, 110.5}, {90.5, 30.5}}) {
    const Eigen::Vector2d at = Eigen::Vector2d(2, -3) + ground_from_pixel(view, pixel).value();
    const auto color = frame.rgb.at<cv::Vec3b>(static_cast<int>(pixel.y()), static_cast<int>(pixel.x()));
    EXPECT_NEAR(color[0], (200 + 10 * at.x()) / 2, 1.5);
    EXPECT_NEAR(color[1], (200 - 10 * at.y()) / 2, 1.5);
  }
}

TEST(Rasterise, ATriangleCoversItsAreaAndHasItsDepth) {
  const Camera camera{200, 200, 180, 180, 100, 100};
  const Triangle triangle{{Eigen::Vector3d(-2, -2, 2), Eigen::Vector3d(3, -1, 2), Eigen::Vector3d(0, 2.5, 2)}, kRed};
  const RasterisedFrame frame = rasterise({triangle}, gray_ground(), camera, straight_down(10));
  const double area_m2 = 0.5 * std::abs(5.0 * 4.5 - 1.0 * 2.0);
  EXPECT_NEAR(red_pixels(frame.rgb) * std::pow(8.0 / 180, 2), area_m2, 0.02 * area_m2);
  EXPECT_FLOAT_EQ(frame.inverse.at<float>(200, 200), 1 / 8.0F);
  EXPECT_FLOAT_EQ(frame.inverse.at<float>(5, 5), 1 / 10.0F);
}

// A plane through (0, 0, 3) that rises to the east: its depth at a pixel is where the ray meets it.
TEST(Rasterise, DepthOfATiltedTriangleIsThatOfItsPlane) {
  const Camera camera{200, 200, 180, 180, 100, 100};
  const auto on = [](double east, double north) { return Eigen::Vector3d(east, north, 3 + 0.5 * east); };
  const RasterisedFrame frame =
      rasterise({{{on(-4, -4), on(4, -4), on(0, 4)}, kRed}}, gray_ground(), camera, straight_down(10));
  for (const int col : {150, 200, 260}) {
    const double slope = (col + 0.5 - 200) / 360;  // east per metre of depth
    const double depth_m = 7 / (1 + 0.5 * slope);
    EXPECT_NEAR(1 / frame.inverse.at<float>(200, col), depth_m, 1e-4) << col;
  }
}

TEST(Rasterise, TheNearerSurfaceHidesTheOtherInAnyOrder) {
  const Camera camera{100, 100, 90, 90, 50, 50};
  const auto at = [](double up, Paint color) {
    return Triangle{{Eigen::Vector3d(-9, -9, up), Eigen::Vector3d(9, -9, up), Eigen::Vector3d(0, 9, up)}, color};
  };
  const Triangle low = at(1, kRed);
  const Triangle high = at(4, {0, 0, 200});
  for (const Mesh& mesh : {Mesh{low, high}, Mesh{high, low}}) {
    const RasterisedFrame frame = rasterise(mesh, gray_ground(), camera, straight_down(10));
    EXPECT_EQ(frame.rgb.at<cv::Vec3b>(50, 50)[0], 0);
    EXPECT_GT(frame.rgb.at<cv::Vec3b>(50, 50)[2], 100);
  }
}

// From a point of its axis a torus is seen between the tangents to its tube.
TEST(Rasterise, SilhouetteOfATorusIsThatOfItsTangents) {
  const Camera camera{400, 400, 500, 500, 200, 200};
  Mesh mesh;
  add_torus(mesh, {0, 0, 5}, Eigen::Vector3d::UnitY(), 1.5, 0.2, kRed);
  const RasterisedFrame frame = rasterise(mesh, gray_ground(), camera, looking({0, -6, 5}, {0, 0, 5}));
  const double middle = std::atan2(1.5, 6.0);
  const double half = std::asin(0.2 / std::hypot(1.5, 6.0));
  const double area_px =
      std::numbers::pi * 500 * 500 * (std::pow(std::tan(middle + half), 2) - std::pow(std::tan(middle - half), 2));
  EXPECT_NEAR(red_pixels(frame.rgb), area_px, 0.02 * area_px);
}

TEST(Rasterise, RefusesACameraWithDistortion) {
  Camera camera{100, 100, 90, 90, 50, 50};
  camera.distortion_model = DistortionModel::kBrownConrady;
  EXPECT_THROW(rasterise({}, gray_ground(), camera, straight_down(10)), UsageError);
}

}  // namespace
}  // namespace pilotage
