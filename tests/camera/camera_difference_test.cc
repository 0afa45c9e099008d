#include "pilotage/camera/camera_difference.h"

#include <cmath>

#include "testing/pinhole_camera.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

TEST(CameraDifference, TheSizeOfTheImageDoesNotMatter) {
  const Camera camera = testing::pinhole_camera(4000, 2250, 3000);
  EXPECT_EQ(camera_difference_deg(camera, camera), 0);
  EXPECT_LT(camera_difference_deg(camera, resized_camera(camera, 1000, 562)), 0.05);
  EXPECT_TRUE(std::isinf(camera_difference_deg(camera, testing::pinhole_camera(4000, 3000, 3000))));
}

TEST(CameraDifference, IsTheLargestAngleBetweenRays) {
  const Camera camera = testing::pinhole_camera(1000, 1000, 1000);
  Camera tilted = camera;
  tilted.mount.pitch_deg = 3;
  EXPECT_NEAR(camera_difference_deg(camera, tilted), 3, 1e-9) << "in the middle column every ray turns by 3°";
  // The corner lies 500·√2 px off the axis.
  const Camera longer = testing::pinhole_camera(1000, 1000, 1050);
  const double corner_deg = (std::atan(std::sqrt(0.5)) - std::atan(std::sqrt(0.5) / 1.05)) * 180 / 3.14159265358979;
  EXPECT_NEAR(camera_difference_deg(camera, longer), corner_deg, 1e-9);
  EXPECT_EQ(camera_difference_deg(longer, camera), camera_difference_deg(camera, longer));
}

TEST(CameraDifference, RefusesWhatIsNoCamera) {
  EXPECT_THROW(camera_difference_deg(Camera{}, testing::pinhole_camera(10, 10, 10)), DataError);
}

}  // namespace
}  // namespace pilotage
