#include "pilotage/camera/camera.h"

#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

Camera ideal_camera(int width_px, int height_px) {
  Camera camera;
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.fx_px = camera.fy_px = width_px;
  camera.cx_px = width_px / 2.0;
  camera.cy_px = height_px / 2.0;
  return camera;
}

TEST(CameraForSize, TheSameShapeIsResized) {
  const Camera camera = ideal_camera(4000, 2250);
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
