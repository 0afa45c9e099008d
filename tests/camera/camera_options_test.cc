#include "pilotage/camera/camera_options.h"

#include <cmath>
#include <numbers>

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

std::string camera_error(const CameraOptions& options, const std::optional<RouteCamera>& route = std::nullopt) {
  return testing::error_of<UsageError>([&] { make_camera(options, route); });
}

CameraOptions field_of_view() {
  CameraOptions options;
  options.hfov_deg = 73.7;
  options.width_px = 4000;
  options.height_px = 2250;
  return options;
}

CameraOptions sensor() {
  CameraOptions options;
  options.sensor_width_mm = 13.2;
  options.sensor_height_mm = 8.8;
  options.focal_length_mm = 8.8;
  options.width_px = 5472;
  options.height_px = 3648;
  return options;
}

TEST(CameraOptions, FlagsAreThoseOfTheCommandLine) {
  struct Outer {
    CameraOptions camera;
    static void describe(Outer& self, options_detail::FieldCollector& fields) {
      fields.group("camera", self.camera, "How the aircraft sees the ground.");
    }
  } outer;
  const OptionList list = list_options(outer);
  EXPECT_EQ(list.find("camera.hfov_deg")->flag, "camera-hfov-deg");
  EXPECT_EQ(list.find("camera.mount_pitch_deg")->flag, "camera-mount-pitch-deg");
  EXPECT_EQ(list.find("camera.file")->flag, "camera");
}

TEST(CameraOptions, FieldOfView) {
  CameraOptions options = field_of_view();
  options.mount_pitch_deg = 20;
  const Camera camera = make_camera(options);
  EXPECT_NEAR(2 * std::atan(2000 / camera.fx_px) * 180 / std::numbers::pi, 73.7, 1e-12);
  EXPECT_EQ(camera.fx_px, camera.fy_px);
  EXPECT_EQ(camera.cx_px, 2000);
  EXPECT_EQ(camera.cy_px, 1125);
  EXPECT_EQ(camera.mount.pitch_deg, 20);
}

TEST(CameraOptions, Sensor) {
  const Camera camera = make_camera(sensor());
  EXPECT_NEAR(camera.fx_px, 3648, 1e-9);  // 8.8 / 13.2 · 5472
  EXPECT_NEAR(camera.fy_px, 3648, 1e-9);
  EXPECT_EQ(camera.height_px, 3648);
}

TEST(CameraOptions, RouteCameraServesWhenNothingIsGiven) {
  const RouteCamera route{"P4", 13.2, 8.8, 8.8, 5472, 3648};
  Camera expected = make_camera(sensor());
  CameraOptions options;
  options.mount_yaw_deg = 90;
  expected.mount.yaw_deg = 90;
  EXPECT_EQ(make_camera(options, route), expected);
  EXPECT_EQ(make_camera(field_of_view(), route), make_camera(field_of_view()));

  RouteCamera incomplete = route;
  incomplete.focal_length_mm = 0;
  EXPECT_THROW(make_camera({}, incomplete), DataError);
}

TEST(CameraOptions, File) {
  const testing::TemporaryFolder folder;
  write_file(folder / "camera.yaml",
             "camera_model: pinhole\nintrinsics: [500, 501, 319.5, 239.5]\ndistortion_model: none\n"
             "resolution: [640, 480]\n",
             false);
  CameraOptions options;
  options.file = folder / "camera.yaml";
  EXPECT_EQ(make_camera(options), (Camera{640, 480, 500, 501, 320, 240}));
  options.width_px = 640;
  EXPECT_THAT(camera_error(options), HasSubstr("--camera and --camera-width-px exclude each other"));
  options.file = folder / "none.yaml";
  options.width_px.reset();
  EXPECT_THROW(make_camera(options), DataError);
}

TEST(CameraOptions, SaysWhatIsMissing) {
  EXPECT_THAT(camera_error({}), HasSubstr("no camera: give --camera FILE, or"));
  CameraOptions options = field_of_view();
  options.height_px.reset();
  EXPECT_EQ(camera_error(options), "--camera-hfov-deg needs --camera-height-px too");
  options.width_px.reset();
  EXPECT_EQ(camera_error(options), "--camera-hfov-deg needs --camera-width-px, --camera-height-px too");
  options = sensor();
  options.focal_length_mm.reset();
  options.width_px.reset();
  EXPECT_EQ(camera_error(options), "--camera-sensor-width-mm needs --camera-focal-length-mm, --camera-width-px too");
  options = {};
  options.width_px = 10;
  EXPECT_EQ(camera_error(options), "--camera-width-px needs --camera-height-px too");
  options.height_px = 10;
  EXPECT_THAT(camera_error(options), HasSubstr("needs --camera-hfov-deg too, or --camera-sensor-width-mm"));
  // A route's camera does not complete half-given options.
  EXPECT_NE(camera_error(options, RouteCamera{"P4", 13.2, 8.8, 8.8, 5472, 3648}), "");
}

TEST(CameraOptions, RefusesContradictionsAndNonsense) {
  CameraOptions options = sensor();
  options.hfov_deg = 70;
  EXPECT_THAT(camera_error(options), HasSubstr("--camera-hfov-deg and --camera-sensor-width-mm"));
  options = sensor();
  options.height_px = 3078;  // a 16:9 crop of the 3:2 sensor
  EXPECT_THAT(camera_error(options), HasSubstr("Give the part of the sensor that the image shows"));
  options = field_of_view();
  options.hfov_deg = 180;
  EXPECT_THAT(camera_error(options), HasSubstr("hfov_deg = 180 is outside [3.15, 179]"));
  options.hfov_deg = 1.2;
  EXPECT_THAT(camera_error(options), HasSubstr("hfov_deg = 1.2 is outside [3.15, 179]"));
  options.hfov_deg = 3.2;
  EXPECT_EQ(camera_error(options), "");
}

}  // namespace
}  // namespace pilotage
