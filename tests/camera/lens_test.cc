#include "pilotage/camera/lens.h"

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

Camera camera_with(DistortionModel model, std::array<double, 5> distortion) {
  Camera camera{4000, 2250, 2600, 2610, 2010.5, 1120.25};
  camera.distortion_model = model;
  camera.distortion = distortion;
  return camera;
}

const std::vector<Camera> kCameras{
    camera_with(DistortionModel::kNone, {}),
    camera_with(DistortionModel::kBrownConrady, {-0.28, 0.09, 0.0012, -0.0007, -0.011}),
    camera_with(DistortionModel::kBrownConrady, {0.12, -0.05, -0.002, 0.001, 0.02}),
    camera_with(DistortionModel::kFisheye, {-0.013, 0.021, -0.011, 0.002, 0}),
};

/// OpenCV's own projection, first pixel centre at 0.
Eigen::Vector2d opencv_pixel(const Camera& camera, const Eigen::Vector3d& ray) {
  const cv::Matx33d k(camera.fx_px, 0, camera.cx_px - 0.5, 0, camera.fy_px, camera.cy_px - 0.5, 0, 0, 1);
  const std::vector<cv::Point3d> points{{ray.x(), ray.y(), ray.z()}};
  std::vector<cv::Point2d> pixels;
  const auto& d = camera.distortion;
  if (camera.distortion_model == DistortionModel::kFisheye) {
    cv::fisheye::projectPoints(points, pixels, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), k,
                               cv::Vec4d(d[0], d[1], d[2], d[3]));
  } else {
    cv::projectPoints(points, cv::Vec3d(0, 0, 0), cv::Vec3d(0, 0, 0), k, std::vector<double>(d.begin(), d.end()),
                      pixels);
  }
  return {pixels[0].x + 0.5, pixels[0].y + 0.5};
}

TEST(Lens, ProjectsAsOpenCvDoesHalfAPixelApart) {
  Random random(seed_from_name("ProjectsAsOpenCvDoes"));
  for (const Camera& camera : kCameras) {
    const Lens lens = make_lens(camera);
    for (int i = 0; i < 200; ++i) {
      const Eigen::Vector3d ray(random.uniform(-0.8, 0.8), random.uniform(-0.45, 0.45), 1);
      const auto pixel = pixel_from_ray(lens, ray * random.uniform(0.1, 1000));
      ASSERT_TRUE(pixel);
      EXPECT_LT((*pixel - opencv_pixel(camera, ray)).norm(), 1e-8);
    }
  }
}

TEST(Lens, RayOfPixelIsTheInverse) {
  Random random(seed_from_name("RayOfPixelIsTheInverse"));
  for (const Camera& camera : kCameras) {
    const Lens lens = make_lens(camera);
    for (int i = 0; i < 2000; ++i) {
      const Eigen::Vector2d pixel(random.uniform(0, 4000), random.uniform(0, 2250));
      const auto ray = ray_from_pixel(lens, pixel);
      ASSERT_TRUE(ray) << pixel.transpose();
      EXPECT_NEAR(ray->norm(), 1, 1e-14);
      EXPECT_LT((*pixel_from_ray(lens, *ray) - pixel).norm(), 1e-6);
    }
    const auto axis = ray_from_pixel(lens, {camera.cx_px, camera.cy_px});
    ASSERT_TRUE(axis);
    EXPECT_LT((*axis - Eigen::Vector3d(0, 0, 1)).norm(), 1e-15);
  }
}

TEST(Lens, RaysBeyondTheFoldHaveNoPixel) {
  // x (1 − 0.3 x²) rises until x = 1/sqrt(0.9) and then comes back through the image.
  const Camera camera = camera_with(DistortionModel::kBrownConrady, {-0.3, 0, 0, 0, 0});
  const Lens lens = make_lens(camera);
  const double fold = 1 / std::sqrt(0.9);
  EXPECT_NEAR(lens.max_radius, fold, 1e-12);
  EXPECT_TRUE(pixel_from_ray(lens, {fold * 0.9999, 0, 1}));
  EXPECT_FALSE(pixel_from_ray(lens, {fold * 1.0001, 0, 1}));
  EXPECT_LT(opencv_pixel(camera, {1.8, 0, 1}).x(), 4000);  // which OpenCV puts inside the image
  EXPECT_FALSE(pixel_from_ray(lens, {1.8, 0, 1}));
  const double last_px = camera.cx_px + camera.fx_px * fold * (1 - 0.3 * fold * fold);
  EXPECT_TRUE(ray_from_pixel(lens, {last_px - 0.01, camera.cy_px}));
  EXPECT_FALSE(ray_from_pixel(lens, {last_px + 0.01, camera.cy_px}));
}

TEST(Lens, FindsTheFirstOfSeveralFolds) {
  // d/dr = (1 − u/0.5)(1 − u/2)  →  3 a0 = −2.5, 5 a1 = 1.
  const Lens lens = make_lens(camera_with(DistortionModel::kBrownConrady, {-2.5 / 3, 0.2, 0, 0, 0}));
  EXPECT_NEAR(lens.max_radius, std::sqrt(0.5), 1e-12);
}

TEST(Lens, FisheyeSeesBehindItself) {
  const Lens lens = make_lens(camera_with(DistortionModel::kFisheye, {}));
  const auto pixel = pixel_from_ray(lens, {1, 0, -0.5});
  ASSERT_TRUE(pixel);
  EXPECT_NEAR(pixel->x(), 2010.5 + 2600 * std::atan2(1, -0.5), 1e-9);
  EXPECT_NEAR((*ray_from_pixel(lens, *pixel) - Eigen::Vector3d(1, 0, -0.5).normalized()).norm(), 0, 1e-12);
  EXPECT_FALSE(pixel_from_ray(make_lens(kCameras[0]), {1, 0, -0.5}));
  EXPECT_FALSE(pixel_from_ray(lens, {0, 0, -1}));
}

TEST(Lens, NothingForWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const Camera& camera : kCameras) {
    const Lens lens = make_lens(camera);
    EXPECT_FALSE(pixel_from_ray(lens, {nan, 0, 1}));
    EXPECT_FALSE(ray_from_pixel(lens, {nan, 0}));
    EXPECT_FALSE(ray_from_pixel(lens, {0, inf}));
    EXPECT_FALSE(ray_from_pixel(lens, {1e300, -1e300}));
  }
}

TEST(Camera, ProblemsNameTheValue) {
  Camera camera = kCameras[1];
  EXPECT_EQ(camera_problem(camera), "");
  camera.fx_px = 0;
  EXPECT_EQ(camera_problem(camera), "fx_px = 0 is not in [0.001, 1e9]");
  camera = kCameras[1];
  camera.distortion[3] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(camera_problem(camera), "a distortion coefficient = nan is not in [-1e9, 1e9]");
  camera = kCameras[1];
  camera.width_px = 0;
  EXPECT_EQ(camera_problem(camera), "width_px = 0 is not in [1, 100000]");
  EXPECT_THROW(make_lens(camera), DataError);
}

TEST(Camera, ResizingKeepsRays) {
  for (const Camera& camera : kCameras) {
    const Camera small = resized_camera(camera, 1000, 750);
    const auto ray = ray_from_pixel(make_lens(camera), {400, 300});
    const auto small_ray = ray_from_pixel(make_lens(small), {100, 100});
    EXPECT_LT((*ray - *small_ray).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace pilotage
