#include "pilotage/camera/camera_file.h"

#include "testing/error_of.h"
#include "testing/replaced.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::replaced;

const std::string kRos = R"(image_width: 640
image_height: 480
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [600.5, 0., 319.5, 0., 601.25, 239.5, 0., 0., 1.]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.25, 0.07, 1.5e-4, -2E-4, 0.001]
rectification_matrix:
  rows: 3
  cols: 3
  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]
)";

const std::string kOpenCv = R"(%YAML:1.0
---
calibration_time: "Thu 02 Jan 2020 03:04:05"
image_width: 640
image_height: 480
flags: 0
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 6.0050000000000000e+02, 0., 3.1950000000000000e+02, 0.,
       6.0125000000000000e+02, 2.3950000000000000e+02, 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 5
   cols: 1
   dt: d
   data: [ -2.5000000000000000e-01, 7.0000000000000007e-02,
       1.5e-04, -2.0e-04, 1.0e-03 ]
)";

const std::string kKalibr = R"(cam0:
  cam_overlaps: []
  camera_model: pinhole
  distortion_coeffs: [-0.25, 0.07, 1.5e-4, -2e-4]
  distortion_model: radtan
  intrinsics: [600.5, 601.25, 319.5, 239.5]
  resolution: [640, 480]
  rostopic: /cam0/image_raw
)";

Camera expected_camera(double k3) {
  Camera camera{640, 480, 600.5, 601.25, 320, 240};
  camera.distortion_model = DistortionModel::kBrownConrady;
  camera.distortion = {-0.25, 0.07, 1.5e-4, -2e-4, k3};
  return camera;
}

std::string yaml_error(const std::string& yaml) {
  return testing::error_of<DataError>([&] { parse_camera_file("c.yaml", yaml); });
}

TEST(CameraFile, ThreeDialectsOneCamera) {
  EXPECT_EQ(parse_camera_file("c.yaml", kRos), expected_camera(0.001));
  EXPECT_EQ(parse_camera_file("c.yaml", kOpenCv), expected_camera(0.001));
  EXPECT_EQ(parse_camera_file("c.yaml", kKalibr), expected_camera(0));
}

TEST(CameraFile, ReadsFromDisk) {
  const testing::TemporaryFolder folder;
  write_file(folder / "c.yaml", kOpenCv, false);
  EXPECT_EQ(read_camera_file(folder / "c.yaml"), expected_camera(0.001));
  EXPECT_THROW(read_camera_file(folder / "absent.yaml"), DataError);
  EXPECT_THROW(read_camera_file(folder.path()), DataError);
}

TEST(CameraFile, OtherSpellings) {
  std::string text = replaced(kOpenCv, "camera_matrix", "cameraMatrix");
  text = replaced(text, "distortion_coefficients", "distCoeffs");
  text = replaced(text, "image_width", "image_Width");
  EXPECT_EQ(parse_camera_file("c.yaml", text), expected_camera(0.001));
  EXPECT_EQ(parse_camera_file("c.yaml", replaced(kKalibr, "cam0:\n", "cam3:\n")), expected_camera(0));
}

TEST(CameraFile, Fisheye) {
  std::string text = replaced(kRos, "plumb_bob", "equidistant");
  text = replaced(text, "cols: 5\n  data: [-0.25, 0.07, 1.5e-4, -2E-4, 0.001]", "cols: 4\n  data: [0, 0, 0, 0]");
  EXPECT_EQ(parse_camera_file("c.yaml", text).distortion_model, DistortionModel::kFisheye);
  const Camera kalibr = parse_camera_file("c.yaml", replaced(kKalibr, "radtan", "equidistant"));
  EXPECT_EQ(kalibr.distortion_model, DistortionModel::kFisheye);
  EXPECT_EQ(kalibr.distortion[3], -2e-4);
  text = replaced(kOpenCv, "flags: 0", "fisheye_model: 1");
  text = replaced(text, "1.0e-03", "0.");
  EXPECT_EQ(parse_camera_file("c.yaml", text).distortion_model, DistortionModel::kFisheye);
}

const std::string kRosMessage = R"(header: {stamp: {sec: 10, nanosec: 0}, frame_id: down}
height: 1200
width: 1920
distortion_model: plumb_bob
d: [-0.01, 0.002, 0.0, 0.0, 0.0]
k: [1500.0, 0.0, 959.5, 0.0, 1500.0, 599.5, 0.0, 0.0, 1.0]
r: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]
binning_x: 0
binning_y: 0
roi: {x_offset: 0, y_offset: 0, height: 0, width: 0, do_rectify: false}
)";

const std::string kOpenCvXml = R"(<?xml version="1.0"?>
<opencv_storage>
<calibration_time>"Thu 02 Jan 2020 03:04:05"</calibration_time>
<image_width>640</image_width>
<image_height>480</image_height>
<camera_matrix type_id="opencv-matrix">
  <rows>3</rows>
  <cols>3</cols>
  <dt>d</dt>
  <data>
    600.5 0. 319.5 0. 601.25 239.5 0. 0. 1.</data></camera_matrix>
<distortion_coefficients type_id="opencv-matrix">
  <rows>5</rows>
  <cols>1</cols>
  <dt>d</dt>
  <data>
    -0.25 0.07 1.5e-4 -2E-4 0.001</data></distortion_coefficients>
</opencv_storage>
)";

TEST(CameraFile, MessagesOfRos) {
  const Camera ros2 = parse_camera_file("c.yaml", kRosMessage);
  EXPECT_EQ(ros2.width_px, 1920);
  EXPECT_EQ(ros2.fx_px, 1500);
  EXPECT_EQ(ros2.cx_px, 960);
  EXPECT_EQ(ros2.cy_px, 600);
  EXPECT_EQ(ros2.distortion[1], 0.002);
  const std::string ros1 = replaced(replaced(kRosMessage, "\nd: ", "\nD: "), "\nk: ", "\nK: ");
  EXPECT_EQ(parse_camera_file("c.yaml", ros1), ros2);
  const std::string rows = replaced(kRosMessage, "[1500.0, 0.0, 959.5, 0.0, 1500.0, 599.5, 0.0, 0.0, 1.0]\nr",
                                    "[[1500, 0, 959.5], [0, 1500, 599.5], [0, 0, 1]]\nr");
  EXPECT_EQ(parse_camera_file("c.yaml", rows), ros2);
  EXPECT_EQ(yaml_error(replaced(ros1, "\nK: ", "\nk: [1]\nK: ")), "c.yaml: \"K\" and \"k\" both stand there");
}

// What the message says of the sensor is not what its pictures show.
TEST(CameraFile, BinningAndARegionOfInterest) {
  const std::string binned =
      replaced(replaced(kRosMessage, "binning_x: 0", "binning_x: 2"), "binning_y: 0", "binning_y: 3");
  const Camera coarse = parse_camera_file("c.yaml", binned);
  EXPECT_EQ(coarse.width_px, 960);
  EXPECT_EQ(coarse.height_px, 400);
  EXPECT_EQ(coarse.fx_px, 750);
  EXPECT_EQ(coarse.fy_px, 500);
  EXPECT_EQ(coarse.cx_px, 480);
  EXPECT_EQ(coarse.cy_px, 200);
  const std::string whole = "x_offset: 0, y_offset: 0, height: 0, width: 0";
  const std::string part = replaced(kRosMessage, whole, "x_offset: 640, y_offset: 360, height: 480, width: 640");
  const Camera cut = parse_camera_file("c.yaml", part);
  EXPECT_EQ(cut.width_px, 640);
  EXPECT_EQ(cut.height_px, 480);
  EXPECT_EQ(cut.fx_px, 1500);
  EXPECT_EQ(cut.cx_px, 320);
  EXPECT_EQ(cut.cy_px, 240);
  const Camera both = parse_camera_file("c.yaml", replaced(part, "binning_x: 0", "binning_x: 2"));
  EXPECT_EQ(both.width_px, 320);
  EXPECT_EQ(both.cx_px, 160);
  EXPECT_EQ(both.cy_px, 240);
  EXPECT_EQ(yaml_error(replaced(part, "x_offset: 640", "x_offset: 1300")),
            "c.yaml: roi: leaves the image of 1920 x 1200 px");
  EXPECT_EQ(yaml_error(replaced(part, "height: 480", "height: 0")),
            "c.yaml: roi: width and height are 0 together, or neither");
  EXPECT_EQ(yaml_error(replaced(binned, "binning_x: 2", "binning_x: -2")),
            "c.yaml: binning_x = -2 is not a whole number in [0, 100000]");
  EXPECT_EQ(yaml_error(replaced(binned, "binning_x: 2", "binning_x: 2000")), "c.yaml: binning leaves no pixel");
}

TEST(CameraFile, FourCoefficientsNeedAModel) {
  const std::string four = replaced(kOpenCv,
                                    "rows: 5\n   cols: 1\n   dt: d\n   data: [ -2.5000000000000000e-01, "
                                    "7.0000000000000007e-02,\n       1.5e-04, -2.0e-04, 1.0e-03 ]",
                                    "rows: 4\n   cols: 1\n   dt: d\n   data: [ -0.021, 0.0058, -0.0041, 0.0009 ]");
  EXPECT_THAT(yaml_error(four), HasSubstr("c.yaml: distortion_coefficients has four numbers and no model: OpenCV's "
                                          "fisheye writes four (k1 … k4)"));
  const Camera brown = parse_camera_file("c.yaml", four + "distortion_model: plumb_bob\n");
  EXPECT_EQ(brown.distortion_model, DistortionModel::kBrownConrady);
  EXPECT_EQ(brown.distortion[2], -0.0041);
  const Camera fisheye = parse_camera_file("c.yaml", four + "distortion_model: equidistant\n");
  EXPECT_EQ(fisheye.distortion_model, DistortionModel::kFisheye);
  EXPECT_EQ(parse_camera_file("c.yaml", replaced(four, "flags: 0", "fisheye_model: 1")), fisheye);
  EXPECT_THAT(yaml_error(four + "distortion_model: \"\"\n"), HasSubstr("no model"));
  EXPECT_EQ(
      parse_camera_file("c.yaml", replaced(four, "-0.021, 0.0058, -0.0041, 0.0009", "0, 0, 0, 0")).distortion_model,
      DistortionModel::kNone);
}

TEST(CameraFile, OpenCvsXmlIsItsYaml) {
  EXPECT_EQ(parse_camera_file("c.xml", kOpenCvXml), expected_camera(0.001));
  EXPECT_EQ(yaml_error(replaced(kOpenCvXml, "600.5", "six")),
            "c.yaml: camera_matrix: data = \"six\" is not a finite number");
  EXPECT_EQ(yaml_error(replaced(kOpenCvXml, "<image_width>640</image_width>",
                                "<image_width>640</image_width><image_width>1</image_width>")),
            "c.yaml: \"image_width\" and \"image_width\" both stand there");
  EXPECT_THAT(yaml_error("<a><b>1</b></a>"), HasSubstr("XML with the root <a>"));
  EXPECT_THAT(yaml_error("<a><b>1</a>"), HasSubstr("is not well-formed XML"));
}

TEST(CameraFile, ZeroDistortionIsNone) {
  const std::string text = replaced(kRos, "[-0.25, 0.07, 1.5e-4, -2E-4, 0.001]", "[0, 0, 0, 0, 0.0]");
  EXPECT_EQ(parse_camera_file("c.yaml", text).distortion_model, DistortionModel::kNone);
}

TEST(CameraFile, LongerModelsOnlyWhenTheyAddNothing) {
  const std::string zero = replaced(kRos, "cols: 5\n  data: [-0.25, 0.07, 1.5e-4, -2E-4, 0.001]",
                                    "cols: 8\n  data: [-0.25, 0.07, 1.5e-4, -2E-4, 0.001, 0, 0, 0]");
  EXPECT_EQ(parse_camera_file("c.yaml", zero), expected_camera(0.001));
  EXPECT_EQ(
      yaml_error(replaced(zero, "0, 0, 0]", "0, 0.5, 0]")),
      "c.yaml: distortion_coefficients has a coefficient 0.5 beyond the first 5, of a distortion model that cannot "
      "be used");
}

TEST(CameraFile, ErrorsNameTheKey) {
  EXPECT_EQ(yaml_error(replaced(kRos, "image_width: 640\n", "")), "c.yaml: \"image_width\" is missing");
  EXPECT_EQ(yaml_error(replaced(kRos, "640", "-640")),
            "c.yaml: image_width = -640 is not a whole number in [1, 100000]");
  EXPECT_EQ(yaml_error(replaced(kRos, "600.5", "six")), "c.yaml: camera_matrix: data = \"six\" is not a finite number");
  EXPECT_EQ(yaml_error(replaced(kRos, "600.5", ".nan")),
            "c.yaml: camera_matrix: data = \".nan\" is not a finite number");
  EXPECT_EQ(yaml_error(replaced(kRos, "600.5", "-600.5")), "c.yaml: fx_px = -600.5 is not in [0.001, 1e9]");
  EXPECT_EQ(yaml_error(replaced(kRos, "600.5, 0.", "600.5, 3")),
            "c.yaml: camera_matrix has skew 3, only 0 can be used");
  EXPECT_EQ(yaml_error(replaced(kRos, "cols: 3", "cols: 4")),
            "c.yaml: camera_matrix: data has 9 numbers, rows x cols is 12");
  EXPECT_THAT(yaml_error(replaced(kRos, "plumb_bob", "mei")), HasSubstr("distortion_model = \"mei\" is not one of"));
  EXPECT_EQ(yaml_error(replaced(kRos, "image_height: 480\n", "image_height: 480\nimage_height: 481\n")),
            "c.yaml: \"image_height\" and \"image_height\" both stand there");
  EXPECT_EQ(yaml_error(replaced(kKalibr, "pinhole", "omni")),
            "c.yaml: cam0: camera_model = \"omni\" cannot be used, only pinhole");
  EXPECT_EQ(yaml_error(replaced(kKalibr, "[640, 480]", "[640]")), "c.yaml: cam0: resolution is not [width, height]");
  EXPECT_EQ(yaml_error(kKalibr + replaced(kKalibr, "cam0:\n", "cam1:\n")),
            "c.yaml: holds 2 cameras (cam0, cam1); keep one of them");
  EXPECT_THAT(yaml_error("a: 1"), HasSubstr("not a camera calibration of ROS or OpenCV"));
  EXPECT_THAT(yaml_error("[1, 2]"), HasSubstr("not a map of keys"));
  EXPECT_THAT(yaml_error(""), HasSubstr("not a map of keys"));
  EXPECT_THAT(yaml_error("a: [1, 2"), HasSubstr("not valid YAML"));
}

TEST(CameraFile, SurvivesTruncationAndFlippedBytes) {
  Random random(seed_from_name("SurvivesTruncationAndFlippedBytes"));
  for (const std::string& text : {kRos, kOpenCv, kKalibr, kRosMessage, kOpenCvXml}) {
    for (std::size_t length = 0; length < text.size(); ++length) {
      try {
        const Camera camera = parse_camera_file("c.yaml", text.substr(0, length));
        EXPECT_EQ(camera_problem(camera), "");
      } catch (const DataError&) {
      }
      std::string flipped = text;
      flipped[length] = static_cast<char>(random.below(256));
      try {
        const Camera camera = parse_camera_file("c.yaml", flipped);
        EXPECT_EQ(camera_problem(camera), "");
      } catch (const DataError&) {
      }
    }
  }
}

}  // namespace
}  // namespace pilotage
