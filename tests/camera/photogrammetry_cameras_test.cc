#include "pilotage/camera/photogrammetry_cameras.h"

#include <cmath>

#include "testing/error_of.h"
#include "testing/replaced.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/camera/camera_file.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::replaced;

const std::string kColmap = R"(# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
# Number of cameras: 1
7 OPENCV 1920 1200 1500 1490 961 602 -0.012 0.009 0.001 -0.002
)";

const std::string kAgisoft = R"(<?xml version="1.0" encoding="UTF-8"?>
<calibration>
  <projection>frame</projection>
  <width>1920</width>
  <height>1200</height>
  <f>1500</f>
  <cx>3.5</cx>
  <cy>-2</cy>
  <b1>10</b1>
  <k1>-0.012</k1>
  <k2>0.009</k2>
  <k3>0.0001</k3>
  <p1>0.001</p1>
  <p2>-0.002</p2>
  <date>2025-10-09T08:53:20Z</date>
</calibration>
)";

std::string problem(const std::string& text) {
  return testing::error_of<DataError>([&] { parse_camera_file("c", text); });
}

TEST(ColmapCameras, CountFromTheCorner) {
  const Camera camera = parse_camera_file("cameras.txt", kColmap);
  EXPECT_EQ(camera.width_px, 1920);
  EXPECT_EQ(camera.height_px, 1200);
  EXPECT_EQ(camera.fx_px, 1500);
  EXPECT_EQ(camera.fy_px, 1490);
  EXPECT_EQ(camera.cx_px, 961);
  EXPECT_EQ(camera.cy_px, 602);
  EXPECT_EQ(camera.distortion_model, DistortionModel::kBrownConrady);
  EXPECT_EQ(camera.distortion, (std::array<double, 5>{-0.012, 0.009, 0.001, -0.002, 0}));
}

TEST(ColmapCameras, AllModels) {
  const auto of = [](const std::string& line) { return parse_camera_file("cameras.txt", "1 " + line + "\n"); };
  EXPECT_EQ(of("SIMPLE_PINHOLE 640 480 500 320 240").fy_px, 500);
  EXPECT_EQ(of("PINHOLE 640 480 500 510 320 240").distortion_model, DistortionModel::kNone);
  EXPECT_EQ(of("SIMPLE_RADIAL 640 480 500 320 240 -0.1").distortion[0], -0.1);
  EXPECT_EQ(of("RADIAL 640 480 500 320 240 0 0").distortion_model, DistortionModel::kNone);
  EXPECT_EQ(of("FULL_OPENCV 640 480 500 500 320 240 1e-2 2e-2 3e-3 4e-3 5e-2 0 0 0").distortion[4], 5e-2);
  const Camera fisheye = of("OPENCV_FISHEYE 1920 1200 600 600 960 600 -0.021 0.0058 -0.0041 0.0009");
  EXPECT_EQ(fisheye.distortion_model, DistortionModel::kFisheye);
  EXPECT_EQ(fisheye.distortion, (std::array<double, 5>{-0.021, 0.0058, -0.0041, 0.0009, 0}));
  EXPECT_EQ(of("RADIAL_FISHEYE 640 480 300 320 240 0 0").distortion_model, DistortionModel::kFisheye);
  EXPECT_EQ(of("SIMPLE_RADIAL_FISHEYE 640 480 300 320 240 0.1").distortion[0], 0.1);
}

TEST(ColmapCameras, ErrorsNameTheLine) {
  EXPECT_THAT(problem(replaced(kColmap, "OPENCV", "FOV")), HasSubstr("c: line 4: the camera model FOV cannot be used"));
  EXPECT_EQ(problem(kColmap + kColmap), "c: holds 2 cameras of COLMAP; keep one of them");
  EXPECT_EQ(problem(replaced(kColmap, " -0.002", "")),
            "c: line 4: OPENCV has 7 numbers, expected fx, fy, cx, cy, k1, k2, p1, p2");
  EXPECT_EQ(problem(replaced(kColmap, "1490", "x")), "c: line 4: fy = \"x\" is not a finite number");
  EXPECT_EQ(problem(replaced(kColmap, "1920", "1920.5")),
            "c: line 4: width = 1920.5 is not a whole number in [1, 100000]");
  EXPECT_THAT(problem("1 FULL_OPENCV 640 480 500 500 320 240 0 0 0 0 0 0.5 0 0"),
              HasSubstr("k4 = 0.5 is of a distortion model that cannot be used"));
}

TEST(AgisoftCalibration, CountsFromTheMiddleAndNamesP1TheOtherWay) {
  const Camera camera = parse_camera_file("c.xml", kAgisoft);
  EXPECT_EQ(camera.width_px, 1920);
  EXPECT_EQ(camera.fx_px, 1510);
  EXPECT_EQ(camera.fy_px, 1500);
  EXPECT_EQ(camera.cx_px, 963.5);
  EXPECT_EQ(camera.cy_px, 598);
  EXPECT_EQ(camera.distortion, (std::array<double, 5>{-0.012, 0.009, -0.002, 0.001, 0.0001}));
  const std::string fisheye = replaced(replaced(replaced(kAgisoft, "frame", "fisheye"), "0.001", "0"), "-0.002", "0");
  EXPECT_EQ(parse_camera_file("c.xml", fisheye).distortion, (std::array<double, 5>{-0.012, 0.009, 0.0001, 0, 0}));
}

TEST(AgisoftCalibration, ErrorsNameTheElement) {
  EXPECT_EQ(problem(replaced(kAgisoft, "<f>1500</f>", "")), "c: <f> is missing");
  EXPECT_EQ(problem(replaced(kAgisoft, "<f>1500</f>", "<f>1500</f><f>1</f>")), "c: <f> stands there 2 times");
  EXPECT_THAT(problem(replaced(kAgisoft, "frame", "spherical")), HasSubstr("only frame and fisheye can"));
  EXPECT_EQ(problem(replaced(kAgisoft, "<b1>10</b1>", "<b2>0.5</b2>")), "c: <b2> = 0.5 is skew, only 0 can be used");
  EXPECT_THAT(problem(replaced(kAgisoft, "<k3>0.0001", "<k4>0.0001</k4><k3>0")), HasSubstr("k4 = 1e-04 is of"));
  EXPECT_THAT(problem(replaced(kAgisoft, "frame", "fisheye")), HasSubstr("p2 = 0.001 is of"));
  EXPECT_THAT(problem(replaced(kAgisoft, "<f>1500</f>", "<fx>1500</fx>")), HasSubstr("old version of Agisoft"));
}

TEST(PhotogrammetryCameras, SurviveTruncationAndFlippedBytes) {
  Random random(seed_from_name("PhotogrammetryCameras"));
  for (const std::string& text : {kColmap, kAgisoft}) {
    for (std::size_t length = 0; length < text.size(); ++length) {
      for (int flip = 0; flip < 2; ++flip) {
        std::string damaged = flip == 0 ? text.substr(0, length) : text;
        if (flip == 1) damaged[length] = static_cast<char>(random.below(256));
        try {
          EXPECT_EQ(camera_problem(parse_camera_file("c", damaged)), "");
        } catch (const DataError&) {
        }
      }
    }
  }
}

}  // namespace
}  // namespace pilotage
