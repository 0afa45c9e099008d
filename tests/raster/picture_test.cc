#include <filesystem>
#include <string>
#include <vector>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/jpeg_segments.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

using testing::error_of;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::make_raster;
using testing::RasterSpec;
using testing::TemporaryFolder;

RasterSpec without_place() {
  RasterSpec spec;
  spec.srs = "";
  spec.georeferenced = false;
  return spec;
}

/// 24 × 16 pixels, a ramp to the right and down.
std::string small_jpeg() {
  cv::Mat pixels(16, 24, CV_8U);
  for (int row = 0; row < 16; ++row) {
    for (int col = 0; col < 24; ++col) pixels.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>(6 * col + 5 * row);
  }
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", pixels, bytes, {cv::IMWRITE_JPEG_QUALITY, 100});
  return {bytes.begin(), bytes.end()};
}

// The one rule: a frame's gray is what the same picture's gray would be in a map.
TEST(ReadGray8Picture, ColoursBecomeGrayAsTheyDoInAMap) {
  const TemporaryFolder folder;
  RasterSpec spec;
  spec.bands = 3;
  spec.creation_options = {"PHOTOMETRIC=RGB"};
  const Raster in_map = open_gray(make_raster(folder / "a.tif", spec)).read({0, 0, 60, 40});
  spec.srs = "";
  spec.georeferenced = false;
  const cv::Mat picture = read_gray8_picture(make_raster(folder / "b.tif", spec));
  ASSERT_EQ(picture.type(), CV_8UC1);
  EXPECT_EQ(cv::norm(picture, in_map.pixels, cv::NORM_INF), 0);
}

TEST(ReadGray8Picture, SixteenBitsAreStretched) {
  const TemporaryFolder folder;
  RasterSpec spec = without_place();
  spec.type = GDT_UInt16;
  spec.width = spec.height = 64;
  spec.value = [](int, int col, int row) { return 1000 + 64 * row + col; };  // 1000 … 5095, each value once
  const cv::Mat picture = read_gray8_picture(make_raster(folder / "a.tif", spec));
  ASSERT_EQ(picture.type(), CV_8UC1);
  // 0.5 % and 99.5 % of 4096 values lie at ranks 21 and 4076: 1020 and 5075.
  EXPECT_EQ(picture.at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(picture.at<std::uint8_t>(63, 63), 255);
  EXPECT_EQ(picture.at<std::uint8_t>(32, 0), static_cast<int>(std::lround(255.0 * (3048 - 1020) / (5075 - 1020))));
}

TEST(ReadGray8Picture, WhatIsTransparentIsBlack) {
  const TemporaryFolder folder;
  RasterSpec spec = without_place();
  spec.bands = 4;
  spec.creation_options = {"PHOTOMETRIC=RGB", "ALPHA=YES"};
  spec.value = [](int band, int col, int) { return band < 3 ? 200 : col < 30 ? 255 : 0; };
  const cv::Mat picture = read_gray8_picture(make_raster(folder / "a.tif", spec));
  EXPECT_EQ(picture.at<std::uint8_t>(5, 29), 200);
  EXPECT_EQ(picture.at<std::uint8_t>(5, 30), 0);
}

// A calibration speaks of the pixels as they are stored; a viewer's rotation would turn frames against it.
TEST(ReadGray8Picture, OrientationIsNotApplied) {
  const TemporaryFolder folder;
  const std::string jpeg = small_jpeg();
  write_file(folder / "plain.jpg", jpeg, false);
  write_file(folder / "turned.jpg", testing::with_orientation(jpeg, 6), false);
  ASSERT_EQ(cv::imread((folder / "turned.jpg").string(), cv::IMREAD_GRAYSCALE).cols, 16) << "the tag is well formed";
  const cv::Mat plain = read_gray8_picture((folder / "plain.jpg").string());
  const cv::Mat turned = read_gray8_picture((folder / "turned.jpg").string());
  ASSERT_EQ(turned.size(), cv::Size(24, 16));
  EXPECT_EQ(cv::norm(plain, turned, cv::NORM_INF), 0);
}

TEST(ReadGray8Picture, WhatIsNoPictureIsNamed) {
  const TemporaryFolder folder;
  write_file(folder / "text.jpg", "not a picture\n", false);
  const std::string text = (folder / "text.jpg").string();
  EXPECT_THAT(error_of<DataError>([&] { read_gray8_picture(text); }),
              HasSubstr(text + ": cannot be opened as a raster"));
  const std::string missing = (folder / "missing.jpg").string();
  EXPECT_THAT(error_of<DataError>([&] { read_gray8_picture(missing); }), HasSubstr(missing));
}

TEST(ReadImageMetadata, AttributesAndElementsOfXmp) {
  const TemporaryFolder folder;
  const std::string packet =
      "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\"><rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">"
      "<rdf:Description rdf:about=\"\" xmlns:drone-dji=\"http://www.dji.com/drone-dji/1.0/\""
      " drone-dji:RelativeAltitude=\" +40.10 \">"
      "<drone-dji:GimbalYawDegree>-12.5</drone-dji:GimbalYawDegree>"
      "<drone-dji:RelativeAltitude>99</drone-dji:RelativeAltitude>"
      "</rdf:Description></rdf:RDF></x:xmpmeta>";
  write_file(folder / "a.jpg", testing::with_xmp(testing::with_orientation(small_jpeg(), 6), packet), false);
  const ImageMetadata metadata = read_image_metadata((folder / "a.jpg").string());
  EXPECT_EQ(metadata.width_px, 24);
  EXPECT_EQ(metadata.height_px, 16);
  EXPECT_EQ(metadata.exif.at("Orientation"), "6");
  EXPECT_EQ(metadata.xmp.at("drone-dji:RelativeAltitude"), "+40.10") << "the first of equal names";
  EXPECT_EQ(metadata.xmp.at("drone-dji:GimbalYawDegree"), "-12.5");
  EXPECT_FALSE(metadata.xmp.contains("xmlns:drone-dji"));
}

TEST(ReadImageMetadata, DamagedXmpIsNone) {
  const TemporaryFolder folder;
  write_file(folder / "a.jpg", testing::with_xmp(small_jpeg(), "<x:xmpmeta><rdf:RDF"), false);
  EXPECT_THAT(read_image_metadata((folder / "a.jpg").string()).xmp, IsEmpty());
  write_file(folder / "b.jpg", small_jpeg(), false);
  EXPECT_THAT(read_image_metadata((folder / "b.jpg").string()).xmp, IsEmpty());
  // Bytes changed at random end in some metadata, or in none.
  const std::string packet = "<x:a xmlns:x=\"u\"><x:b x:c=\"1\" x:d='2'>3</x:b><x:e><!-- 4 -->5</x:e></x:a>";
  Random random(seed_from_name("DamagedXmp"));
  for (int trial = 0; trial < 60; ++trial) {
    std::string damaged = packet;
    damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
    write_file(folder / "d.jpg", testing::with_xmp(small_jpeg(), damaged), true);
    EXPECT_NO_THROW(read_image_metadata((folder / "d.jpg").string())) << damaged;
  }
  // Deep nesting must not end in deep recursion.
  std::string deep;
  for (int i = 0; i < 9000; ++i) deep += "<a>";
  write_file(folder / "c.jpg", testing::with_xmp(small_jpeg(), deep), false);
  EXPECT_NO_THROW(read_image_metadata((folder / "c.jpg").string()));
}

}  // namespace
}  // namespace pilotage
