#include "pilotage/degradation/rectification_error.h"

#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

TEST(RectificationError, HeadingTurnsAndHeightScales) {
  const RectificationError error =
      rectification_error({.heading_sigma_deg = 1.5, .height_sigma_m = 3, .height_m = 150});
  EXPECT_DOUBLE_EQ(error.rotation_deg, 1.5);
  EXPECT_DOUBLE_EQ(error.scale_percent, 2);
  const RectificationError none = rectification_error({});
  EXPECT_EQ(none.rotation_deg, 0);
  EXPECT_EQ(none.scale_percent, 0);
}

/// Rays of a frame meet flat ground with true attitude and height; where the frame is put on the map has them wrong.
/// Local rotation and scale of the one against the other, by differences, without the header's formula.
TEST(RectificationError, AgreesWithProjectionOfDrawnErrors) {
  const RectificationSigma sigma{
      .heading_sigma_deg = 0.3, .tilt_sigma_deg = 0.8, .height_sigma_m = 1, .height_m = 120, .half_fov_deg = 35};
  const RectificationError expected = rectification_error(sigma);
  Random random(seed_from_name("rectification"));
  double rotation2 = 0;
  double scale2 = 0;
  constexpr int kDraws = 40000;
  const double tangent = std::tan(sigma.half_fov_deg * kDegree);
  for (int i = 0; i < kDraws; ++i) {
    const Eigen::Matrix3d attitude =
        (Eigen::AngleAxisd(sigma.heading_sigma_deg * kDegree * random.normal(), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(sigma.tilt_sigma_deg * kDegree * random.normal(), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(sigma.tilt_sigma_deg * kDegree * random.normal(), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    const double height_m = sigma.height_m + sigma.height_sigma_m * random.normal();
    const auto place = [&](double u, double v) {
      const Eigen::Vector3d ray = attitude * Eigen::Vector3d(u, v, 1);
      return Eigen::Vector2d(ray.head<2>() / ray.z() * height_m / sigma.height_m);
    };
    const double u = random.uniform(-tangent, tangent);
    const double v = random.uniform(-tangent, tangent);
    const double step = 1e-5;
    const Eigen::Vector2d by_u = (place(u + step, v) - place(u - step, v)) / (2 * step);
    const Eigen::Vector2d by_v = (place(u, v + step) - place(u, v - step)) / (2 * step);
    const double rotation = (by_u.y() - by_v.x()) / 2;
    const double scale = (by_u.x() + by_v.y()) / 2 - 1;
    rotation2 += rotation * rotation;
    scale2 += scale * scale;
  }
  EXPECT_NEAR(std::sqrt(rotation2 / kDraws) / kDegree, expected.rotation_deg, 0.02 * expected.rotation_deg);
  EXPECT_NEAR(100 * std::sqrt(scale2 / kDraws), expected.scale_percent, 0.02 * expected.scale_percent);
}

TEST(RectificationError, RefusesWhatIsNoSigma) {
  EXPECT_THROW(rectification_error({.heading_sigma_deg = -1}), UsageError);
  EXPECT_THROW(rectification_error({.tilt_sigma_deg = std::numeric_limits<double>::quiet_NaN()}), UsageError);
  EXPECT_THROW(rectification_error({.height_m = 0}), UsageError);
  EXPECT_THROW(rectification_error({.half_fov_deg = 85}), UsageError);
}

}  // namespace
}  // namespace pilotage
