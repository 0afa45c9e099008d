#include "pilotage/flightlog/flight_frames.h"

#include <cmath>

#include "testing/jpeg_segments.h"
#include "testing/pinhole_camera.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using testing::TemporaryFolder;

std::string drone_jpeg() {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", cv::Mat(30, 40, CV_8U, cv::Scalar(90)), bytes);
  return testing::with_xmp({bytes.begin(), bytes.end()},
                           "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:Description drone-dji:RelativeAltitude=\"+80\" "
                           "drone-dji:GpsLatitude=\"55.5\" drone-dji:GpsLongitude=\"16.5\" "
                           "drone-dji:GimbalYawDegree=\"+20\" drone-dji:GimbalPitchDegree=\"-90\" "
                           "drone-dji:GimbalRollDegree=\"0\" drone-dji:CalibratedFocalLength=\"37.5\"/></x:xmpmeta>");
}

FrameTable table_of(const std::string& text) {
  return frame_table_from_csv("frames.csv", text, {FrameTruth::kCenter, FrameColumns::kFileOnly});
}

TEST(CompleteFrames, TheGivenCameraComesFirstThenThePicturesThenTheMaps) {
  const TemporaryFolder folder;
  write_file(folder / "a.jpg", drone_jpeg(), false);
  const FrameTable table = table_of("file,prior_sigma_m\na.jpg,20\n");
  const std::string path = (folder / "frames.csv").string();
  FrameSources sources{testing::pinhole_camera(40, 30, 11), testing::pinhole_camera(40, 30, 12), true, {}};
  EXPECT_EQ(complete_frames(path, table, sources).frames[0].camera.fx_px, 11);
  sources.given.reset();
  sources.exif_mount.yaw_deg = 90;
  FlightFrames frames = complete_frames(path, table, sources);
  EXPECT_EQ(frames.frames[0].camera.fx_px, 37.5);
  EXPECT_EQ(frames.frames[0].camera.mount.yaw_deg, 90);
  EXPECT_EQ(frames.taken.front().field, "camera.fx_px");
  sources.from_exif = false;
  EXPECT_EQ(complete_frames(path, table, sources).frames[0].camera.fx_px, 12);
  sources.of_map.reset();
  EXPECT_THROW(complete_frames(path, table, sources), UsageError);
}

TEST(CompleteFrames, WhatIsNowhereIsToldOf) {
  const TemporaryFolder folder;
  write_file(folder / "a.jpg", drone_jpeg(), false);
  write_file(folder / "b.jpg", "no picture", false);
  const FrameTable table = table_of("file,yaw_deg\na.jpg,7\nb.jpg,\n");
  const std::string path = (folder / "frames.csv").string();
  const FlightFrames frames = complete_frames(path, table, {testing::pinhole_camera(40, 30, 11), {}, true, {}});
  ASSERT_EQ(frames.frames.size(), 2u);
  const FrameRecord& first = frames.frames[0].frame;
  EXPECT_EQ(first.prior.lat_deg, 55.5);
  EXPECT_EQ(first.prior.lon_deg, 16.5);
  EXPECT_EQ(first.height_agl_m, 80);
  EXPECT_EQ(first.attitude.yaw_deg, 7) << "the table wins";
  EXPECT_EQ(first.attitude.pitch_deg, 0);
  EXPECT_THAT(frames.warnings, ElementsAre((folder / "a.jpg").string() + ": prior_sigma_m is not known"));
  EXPECT_EQ(frames.frames[1].path, (folder / "b.jpg").string()) << "matching says that it is no picture";
}

TEST(CompleteFrames, WithoutExifPicturesAreNotLookedAt) {
  const FrameTable table = table_of(
      "file,time_s,prior_lon_deg,prior_lat_deg,prior_sigma_m,height_agl_m,yaw_deg,pitch_deg,roll_deg\n"
      "nowhere.jpg,0,1,2,3,4,5,6,7\n");
  const FlightFrames frames =
      complete_frames("frames.csv", table, {testing::pinhole_camera(40, 30, 11), {}, false, {}});
  EXPECT_THAT(frames.taken, IsEmpty());
  EXPECT_THAT(frames.warnings, IsEmpty());
  EXPECT_EQ(frames.frames[0].frame.attitude.roll_deg, 7);
}

}  // namespace
}  // namespace pilotage
