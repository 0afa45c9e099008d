#include "pilotage/flightlog/frame_exif.h"

#include <cmath>
#include <limits>

#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

ImageMetadata gimbal(const char* yaw, const char* pitch, const char* roll) {
  ImageMetadata metadata{4000, 3000, {}, {}};
  metadata.xmp = {
      {"drone-dji:GimbalYawDegree", yaw}, {"drone-dji:GimbalPitchDegree", pitch}, {"drone-dji:GimbalRollDegree", roll}};
  return metadata;
}

FrameRecord empty_record() {
  FrameRecord frame;
  frame.file = "a.jpg";
  frame.prior = {kNaN, kNaN};
  frame.prior_covariance_en_m2.setConstant(kNaN);
  frame.height_agl_m = kNaN;
  frame.attitude = {kNaN, kNaN, kNaN};
  return frame;
}

void expect_attitude(const Attitude& attitude, double yaw_deg, double pitch_deg, double roll_deg) {
  EXPECT_NEAR(attitude.yaw_deg, yaw_deg, 1e-9);
  EXPECT_NEAR(attitude.pitch_deg, pitch_deg, 1e-9);
  EXPECT_NEAR(attitude.roll_deg, roll_deg, 1e-9);
}

TEST(AttitudeOf, InvertsNedFromBody) {
  Random random(seed_from_name("AttitudeOf"));
  for (int i = 0; i < 1000; ++i) {
    const Attitude attitude{random.uniform(-180, 180), random.uniform(-89.9, 89.9), random.uniform(-180, 180)};
    const Attitude again = attitude_of(ned_from_body(attitude));
    ASSERT_NEAR(again.yaw_deg, attitude.yaw_deg, 1e-7);
    ASSERT_NEAR(again.pitch_deg, attitude.pitch_deg, 1e-7);
    ASSERT_NEAR(again.roll_deg, attitude.roll_deg, 1e-7);
  }
  for (const double pitch_deg : {90.0, -90.0}) {
    const Eigen::Matrix3d straight = ned_from_body({30, pitch_deg, 20});
    EXPECT_LT((ned_from_body(attitude_of(straight)) - straight).norm(), 1e-7);
  }
}

TEST(FrameExif, GimbalPointingDownIsALevelAircraft) {
  expect_attitude(frame_exif(gimbal("+45.00", "-90.00", "+0.00")).camera_attitude->value, 45, 0, 0);
}

TEST(FrameExif, GimbalRaisedLooksAhead) {
  // 60° down is 30° ahead of straight down: a nose raised by 30°.
  expect_attitude(frame_exif(gimbal("-100", "-60", "0")).camera_attitude->value, -100, 30, 0);
}

// At −90° the gimbal's roll turns about the line of sight, as yaw does, and DJI writes some frames with roll 180.
TEST(FrameExif, GimbalRollTurnsAboutTheLineOfSight) {
  expect_attitude(frame_exif(gimbal("30", "-90", "10")).camera_attitude->value, 40, 0, 0);
  expect_attitude(frame_exif(gimbal("-150", "-90", "180")).camera_attitude->value, 30, 0, 0);
}

// Against vectors: the gimbal's own x axis (yaw and pitch as on a compass and a clinometer) is the line of sight.
TEST(FrameExif, LineOfSightIsTheGimbals) {
  Random random(seed_from_name("LineOfSight"));
  for (int i = 0; i < 200; ++i) {
    const double yaw_deg = std::round(random.uniform(-180, 180));
    const double pitch_deg = std::round(random.uniform(-90, -10));
    const ImageMetadata metadata = gimbal(std::to_string(yaw_deg).c_str(), std::to_string(pitch_deg).c_str(), "0");
    const Eigen::Vector3d sight =
        enu_from_camera({}, frame_exif(metadata).camera_attitude->value) * Eigen::Vector3d::UnitZ();
    const double yaw = yaw_deg * M_PI / 180;
    const double pitch = pitch_deg * M_PI / 180;
    const Eigen::Vector3d expected(std::sin(yaw) * std::cos(pitch), std::cos(yaw) * std::cos(pitch), std::sin(pitch));
    ASSERT_LT((sight - expected).norm(), 1e-9) << yaw_deg << " " << pitch_deg;
  }
}

TEST(FillFromExif, MountedCameraSeesWhatTheGimbalSaw) {
  const FrameExif exif = frame_exif(gimbal("70", "-75", "2"));
  const CameraMount mount{90, 20, -5};
  FrameRecord frame = empty_record();
  fill_from_exif(frame, exif, mount);
  EXPECT_LT((enu_from_camera(mount, frame.attitude) - enu_from_camera({}, exif.camera_attitude->value)).norm(), 1e-9);
}

TEST(FillFromExif, FlightAttitudeIsTheAircraftsOwn) {
  ImageMetadata metadata{4000, 3000, {}, {}};
  metadata.xmp = {{"drone-dji:FlightYawDegree", "+44.00"},
                  {"drone-dji:FlightPitchDegree", "+0.10"},
                  {"drone-dji:FlightRollDegree", "+1.80"}};
  FrameRecord frame = empty_record();
  fill_from_exif(frame, frame_exif(metadata), {90, 0, 0});
  expect_attitude(frame.attitude, 44, 0.1, 1.8);
  metadata.xmp.insert({{"drone-dji:GimbalYawDegree", "+45.00"},
                       {"drone-dji:GimbalPitchDegree", "-90.00"},
                       {"drone-dji:GimbalRollDegree", "+0.00"}});
  frame = empty_record();
  fill_from_exif(frame, frame_exif(metadata), {});
  expect_attitude(frame.attitude, 45, 0, 0);
}

TEST(FillFromExif, WhatIsGivenWins) {
  ImageMetadata metadata = gimbal("45", "-90", "0");
  metadata.xmp["drone-dji:RelativeAltitude"] = "+40.10";
  FrameRecord frame = empty_record();
  frame.attitude.yaw_deg = 10;
  frame.prior = {7, kNaN};
  const std::vector<TakenField> taken = fill_from_exif(frame, frame_exif(metadata), {});
  EXPECT_EQ(frame.attitude.yaw_deg, 10);
  EXPECT_EQ(frame.height_agl_m, 40.1);
  std::vector<std::string> fields;
  for (const TakenField& one : taken) fields.push_back(one.field);
  EXPECT_THAT(fields, ElementsAre("height_agl_m", "pitch_deg", "roll_deg"));
  EXPECT_THAT(missing_fields(frame), ElementsAre("prior_lat_deg", "prior_sigma_m"));
}

TEST(FrameExif, PositionPrefersXmpAndKnowsTheMisspeltTag) {
  ImageMetadata metadata{100, 100, {}, {}};
  metadata.exif = {{"GPSLatitude", "(46) (50) (34.3145)"},
                   {"GPSLatitudeRef", "S"},
                   {"GPSLongitude", "(91) (59) (39.0359)"},
                   {"GPSLongitudeRef", "W"}};
  const auto from_exif = frame_exif(metadata).position;
  ASSERT_TRUE(from_exif);
  EXPECT_NEAR(from_exif->value.lat_deg, -46.842865138888889, 1e-12);
  EXPECT_NEAR(from_exif->value.lon_deg, -91.994176638888889, 1e-12);
  metadata.xmp = {{"drone-dji:GpsLatitude", "+46.5"}, {"drone-dji:GpsLongtitude", "-92.25"}};
  const auto from_xmp = frame_exif(metadata).position;
  EXPECT_EQ(from_xmp->value.lat_deg, 46.5);
  EXPECT_EQ(from_xmp->value.lon_deg, -92.25);
  EXPECT_THAT(from_xmp->tag, HasSubstr("GpsLongtitude"));
  metadata.xmp = {{"drone-dji:GpsLatitude", "0.000000"}, {"drone-dji:GpsLongitude", "0.000000"}};
  EXPECT_THAT(frame_exif(metadata).position->tag, HasSubstr("EXIF")) << "0, 0 is no position";
}

TEST(FrameExif, HalfOfATagIsNone) {
  ImageMetadata metadata{100, 100, {}, {}};
  metadata.exif = {{"GPSLatitude", "(46) (50) (34)"}, {"GPSLongitude", "(91) (59) (39)"}};
  EXPECT_FALSE(frame_exif(metadata).position) << "which half of the Earth is not said";
  metadata.exif["GPSLatitudeRef"] = "N";
  metadata.exif["GPSLongitudeRef"] = "E";
  metadata.exif["GPSLongitude"] = "(91) (x) (39)";
  EXPECT_FALSE(frame_exif(metadata).position);
  metadata.exif["GPSLongitude"] = "(191) (0) (0)";
  EXPECT_FALSE(frame_exif(metadata).position);
  metadata.xmp = {{"drone-dji:RelativeAltitude", "nan"}, {"drone-dji:GimbalYawDegree", "3"}};
  EXPECT_FALSE(frame_exif(metadata).height_m);
  EXPECT_FALSE(frame_exif(metadata).camera_attitude);
  EXPECT_FALSE(frame_exif(metadata).focal_length_px);
  EXPECT_FALSE(exif_camera(frame_exif(metadata)));
}

TEST(FrameExif, HeightAboveTheSeaPrefersXmpAndMayBeBelow) {
  ImageMetadata metadata{4000, 3000, {}, {}};
  EXPECT_FALSE(frame_exif(metadata).amsl_m);
  metadata.exif = {{"GPSAltitude", "(12.5)"}, {"GPSAltitudeRef", "0x01"}};
  EXPECT_EQ(frame_exif(metadata).amsl_m->value, -12.5);
  metadata.exif["GPSAltitudeRef"] = "0x00";
  EXPECT_EQ(frame_exif(metadata).amsl_m->value, 12.5);
  metadata.xmp = {{"drone-dji:AbsoluteAltitude", "+198.61"}};
  EXPECT_EQ(frame_exif(metadata).amsl_m->value, 198.61);
}

TEST(FrameExif, TheCamerasClock) {
  ImageMetadata metadata{4000, 3000, {}, {}};
  metadata.exif = {{"DateTimeOriginal", "2016:06:23 16:32:13"}, {"SubSecTimeOriginal", "25"}};
  EXPECT_EQ(frame_exif(metadata).taken_s, 1466699533.25);  // date -u -d '2016-06-23 16:32:13' +%s
  metadata.exif["DateTimeOriginal"] = "2016:06:23";
  EXPECT_FALSE(frame_exif(metadata).taken_s);
}

TEST(FrameExif, FocalLengthFromTheBestTag) {
  ImageMetadata metadata{4000, 3000, {{"FocalLengthIn35mmFilm", "24"}}, {}};
  // 24 mm of a diagonal of 43.267 mm, of 5000 px.
  EXPECT_NEAR(frame_exif(metadata).focal_length_px->value, 24 / 43.26661530556787 * 5000, 1e-9);
  metadata.exif.insert(
      {{"FocalLength", "(4.3)"}, {"FocalPlaneXResolution", "(16393.4)"}, {"FocalPlaneResolutionUnit", "2"}});
  EXPECT_NEAR(frame_exif(metadata).focal_length_px->value, 4.3 * 16393.4 / 25.4, 1e-9);
  metadata.exif["FocalPlaneResolutionUnit"] = "3";  // centimetres
  EXPECT_NEAR(frame_exif(metadata).focal_length_px->value, 4.3 * 16393.4 / 10, 1e-9);
  metadata.xmp["drone-dji:CalibratedFocalLength"] = "3666.666504";
  EXPECT_EQ(frame_exif(metadata).focal_length_px->value, 3666.666504);
  metadata.exif["PixelXDimension"] = "8000";  // a picture made smaller after it was taken
  EXPECT_EQ(frame_exif(metadata).focal_length_px->value, 3666.666504 / 2);
  const Camera camera = exif_camera(frame_exif(metadata))->value;
  EXPECT_EQ(camera.width_px, 4000);
  EXPECT_EQ(camera.cx_px, 2000);
  EXPECT_EQ(camera.cy_px, 1500);
  EXPECT_EQ(camera.fy_px, 3666.666504 / 2);
}

// 16 : 9 is cut from 4 : 3, so the diagonal that the equivalent speaks of is longer than the picture's.
TEST(FrameExif, TwoPlacesInOnePictureAreSaid) {
  ImageMetadata metadata{4000, 3000, {}, {}};
  metadata.xmp = {{"drone-dji:GpsLatitude", "+48.75"}, {"drone-dji:GpsLongitude", "+15.0"}};
  metadata.exif = {{"GPSLatitude", "(48) (45) (36)"},
                   {"GPSLatitudeRef", "N"},
                   {"GPSLongitude", "(15) (0) (0)"},
                   {"GPSLongitudeRef", "E"}};
  const FrameExif exif = frame_exif(metadata);
  EXPECT_EQ(exif.position->tag, "drone-dji:GpsLatitude, drone-dji:GpsLongitude");
  // 36″ of latitude, 1/100°: 1112 m.
  EXPECT_THAT(exif.warnings, ElementsAre(HasSubstr("name two places, 1112 m apart")));
  metadata.exif["GPSLatitude"] = "(48) (45) (0.1)";  // 3 m: two receivers' answers
  EXPECT_THAT(frame_exif(metadata).warnings, IsEmpty());
}

TEST(FrameExif, ADigitalZoomEnlargesTheFocalLength) {
  ImageMetadata metadata{4000, 3000, {}, {}};
  metadata.xmp = {{"drone-dji:CalibratedFocalLength", "3600"}};
  metadata.exif = {{"DigitalZoomRatio", "(1.6)"}};
  EXPECT_NEAR(frame_exif(metadata).focal_length_px->value, 5760, 1e-9);
  EXPECT_THAT(frame_exif(metadata).focal_length_px->tag, HasSubstr("times EXIF DigitalZoomRatio 1.6"));
  for (const char* none : {"(0)", "(1)", "(-2)"}) {
    metadata.exif["DigitalZoomRatio"] = none;
    EXPECT_EQ(frame_exif(metadata).focal_length_px->value, 3600) << none;
  }
  metadata.xmp.clear();
  metadata.exif = {{"DigitalZoomRatio", "(2)"}, {"FocalLengthIn35mmFilm", "24"}};
  const FrameExif film = frame_exif(metadata);
  EXPECT_THAT(film.warnings, ElementsAre(HasSubstr("whether FocalLengthIn35mmFilm counts it is not said")));
  metadata.exif.erase("DigitalZoomRatio");
  EXPECT_EQ(frame_exif(metadata).focal_length_px->value, film.focal_length_px->value);
}

TEST(FrameExif, TheLensOfAPictureThatIsNotCorrected) {
  ImageMetadata metadata{4000, 3000, {}, {}};
  metadata.xmp = {{"drone-dji:CalibratedFocalLength", "3600"},
                  {"drone-dji:DewarpFlag", "0"},
                  {"drone-dji:DewarpData", "2025-01-01;3610,3620,6,-4,-0.12,0.01,0.001,-0.002,0.003"}};
  const auto camera = exif_camera(frame_exif(metadata));
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->tag, "drone-dji:DewarpData");
  EXPECT_EQ(camera->value.fx_px, 3610);
  EXPECT_EQ(camera->value.fy_px, 3620);
  EXPECT_EQ(camera->value.cx_px, 2006);
  EXPECT_EQ(camera->value.cy_px, 1496);
  EXPECT_EQ(camera->value.distortion_model, DistortionModel::kBrownConrady);
  EXPECT_EQ(camera->value.distortion, (std::array<double, 5>{-0.12, 0.01, 0.001, -0.002, 0.003}));
  metadata.xmp["drone-dji:DewarpFlag"] = "1";  // the camera has corrected it
  EXPECT_EQ(exif_camera(frame_exif(metadata))->value.distortion_model, DistortionModel::kNone);
  metadata.xmp["drone-dji:DewarpFlag"] = "0";
  for (const char* broken : {"", "2025-01-01;1,2,3", "2025-01-01;nan,1,0,0,0,0,0,0,0", "-5,1,0,0,0,0,0,0,0"}) {
    metadata.xmp["drone-dji:DewarpData"] = broken;
    EXPECT_EQ(exif_camera(frame_exif(metadata))->value.fx_px, 3600) << broken;
  }
}

TEST(FrameExif, AnOrientationIsNotFollowedAndSaid) {
  ImageMetadata metadata{4000, 3000, {}, {}};
  metadata.exif = {{"Orientation", "6"}};
  EXPECT_THAT(frame_exif(metadata).warnings, ElementsAre(HasSubstr("EXIF Orientation 6 is not followed")));
  metadata.exif["Orientation"] = "1";
  EXPECT_THAT(frame_exif(metadata).warnings, IsEmpty());
}

TEST(FrameExif, WidePicturesAreCutFromATallerFrame) {
  const ImageMetadata wide{4000, 2250, {{"FocalLengthIn35mmFilm", "20"}}, {}};
  EXPECT_NEAR(frame_exif(wide).focal_length_px->value, 20 / 43.26661530556787 * 5000, 1e-9);
}

TEST(FrameExif, RealDronePictures) {
  const auto data = testing::real_data_folder();
  if (data.empty() || !std::filesystem::exists(data / "frames")) GTEST_SKIP() << testing::kNoRealImagery;
  const FrameExif dji = frame_exif(read_image_metadata((data / "frames/brighton_DJI_0021.jpg").string()));
  EXPECT_NEAR(dji.position->value.lat_deg, 46.8428651, 1e-6);
  EXPECT_NEAR(dji.position->value.lon_deg, -91.9941766, 1e-6);
  EXPECT_EQ(dji.height_m->value, 40.1);
  expect_attitude(dji.camera_attitude->value, 45, 0, 0);
  expect_attitude(dji.flight_attitude->value, 44, 0.1, 1.8);
  // The data sheet of its camera (FC300S): 94° across the diagonal of 4000 x 3000 px, so 2331 px.
  EXPECT_NEAR(dji.focal_length_px->value, 2331, 0.05 * 2331);
  FrameRecord frame = empty_record();
  fill_from_exif(frame, frame_exif(read_image_metadata((data / "frames/seneca_IMG_0480.jpg").string())), {});
  EXPECT_NEAR(frame.prior.lat_deg, 41.0370286, 1e-6);  // as its sensefly:Latitude says
  EXPECT_NEAR(frame.prior.lon_deg, -83.3048093, 1e-6);
  EXPECT_THAT(missing_fields(frame), ElementsAre("prior_sigma_m", "height_agl_m", "yaw_deg", "pitch_deg", "roll_deg"));
}

}  // namespace
}  // namespace pilotage
