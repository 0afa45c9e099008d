#include "pilotage/camera/camera.h"

#include "testing/pinhole_camera.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

TEST(CameraForSize, TheSameShapeIsResized) {
  const Camera camera = testing::pinhole_camera(4000, 2250, 4000);
  EXPECT_EQ(camera_for_size("a.jpg", camera, 4000, 2250), camera);
  const Camera half = camera_for_size("a.jpg", camera, 2000, 1125);
  EXPECT_EQ(half.fx_px, 2000);
  EXPECT_EQ(half.cy_px, 562.5);
  EXPECT_EQ(camera_for_size("a.jpg", camera, 1001, 563).width_px, 1001) << "rounded by less than a pixel";
  EXPECT_THROW(camera_for_size("a.jpg", camera, 4000, 3000), DataError);
  EXPECT_THROW(camera_for_size("a.jpg", camera, 2250, 4000), DataError);
  EXPECT_THROW(camera_for_size("a.jpg", camera, 2000, 1128), DataError);
}

}  // namespace
}  // namespace pilotage
