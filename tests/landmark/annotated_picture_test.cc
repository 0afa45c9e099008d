#include "pilotage/landmark/annotated_picture.h"

#include <fstream>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/landmark/outline.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using testing::error_of;
using ::testing::HasSubstr;
using testing::make_raster;
using testing::RasterSpec;
using testing::TemporaryFolder;

class AnnotatedPictureTest : public ::testing::Test {
 protected:
  AnnotatedPictureTest() {
    RasterSpec spec;
    spec.width = 200;
    spec.height = 100;
    make_raster(folder / "a.tif", spec);
  }
  fs::path write(const std::string& name, const std::string& text) {
    fs::create_directories((folder / name).parent_path());
    write_file(folder / name, text, true);
    return folder / name;
  }
  std::vector<AnnotatedPicture> read(const std::string& name, const std::string& text) {
    return read_annotations(write(name, text));
  }
  std::string error(const std::string& name, const std::string& text) {
    return error_of<DataError>([&] { read(name, text); });
  }

  TemporaryFolder folder;
};

void expect_box(const PictureLabel& label, double left, double top, double right, double bottom) {
  ASSERT_EQ(label.outline_px.size(), 4U);
  EXPECT_NEAR((label.outline_px[0] - Vector2d(left, top)).norm(), 0, 1e-9);
  EXPECT_NEAR((label.outline_px[2] - Vector2d(right, bottom)).norm(), 0, 1e-9);
}

TEST_F(AnnotatedPictureTest, ReadsImglab) {
  const auto pictures = read("labels.xml", R"(<?xml version='1.0'?>
<dataset><name>x</name><images>
 <image file='a.tif'>
  <box top='10' left='20' width='40' height='30'><label>tank</label></box>
  <box top='10' left='20' width='40' height='20' angle='1.5707963267948966' ignore='1'><label>hall</label></box>
  <box top='0' left='0' width='9' height='9'><label>roof</label>
   <part name='10' x='0' y='9'/><part name='2' x='9' y='0'/><part name='0' x='0' y='0'/><part name='mast' x='5' y='5'/>
  </box>
 </image>
</images></dataset>)");
  ASSERT_EQ(pictures.size(), 1U);
  EXPECT_EQ(pictures[0].picture, folder / "a.tif");
  ASSERT_EQ(pictures[0].labels.size(), 3U);
  const PictureLabel& upright = pictures[0].labels[0];
  EXPECT_EQ(upright.class_name, "tank");
  EXPECT_TRUE(upright.box_alone);
  EXPECT_FALSE(upright.ignore);
  expect_box(upright, 20, 10, 60, 40);
  const PictureLabel& turned = pictures[0].labels[1];  // about its middle, a quarter turn
  EXPECT_TRUE(turned.ignore);
  EXPECT_FALSE(turned.box_alone);
  expect_box(turned, 50, 0, 30, 40);
  const std::vector<Vector2d> corners = pictures[0].labels[2].outline_px;  // by number, not by text
  EXPECT_EQ(corners, (std::vector<Vector2d>{{0, 0}, {9, 0}, {0, 9}}));
}

TEST_F(AnnotatedPictureTest, ReadsVocPixelsFromOne) {
  fs::create_directories(folder / "JPEGImages");
  fs::rename(folder / "a.tif", folder / "JPEGImages" / "a.tif");
  const auto pictures = read("Annotations/a.xml", R"(<annotation><filename>a.tif</filename>
<object><name>tree</name><difficult>1</difficult><bndbox><xmin>1</xmin><ymin>1</ymin><xmax>10</xmax><ymax>20</ymax></bndbox></object>
<object><name>tree</name><difficult>0</difficult><bndbox><xmin>5</xmin><ymin>5</ymin><xmax>5</xmax><ymax>5</ymax></bndbox></object>
</annotation>)");
  ASSERT_EQ(pictures.size(), 1U);
  expect_box(pictures[0].labels[0], 0, 0, 10, 20);
  EXPECT_TRUE(pictures[0].labels[0].ignore);
  expect_box(pictures[0].labels[1], 4, 4, 5, 5);  // one pixel
  EXPECT_FALSE(pictures[0].labels[1].ignore);
}

TEST_F(AnnotatedPictureTest, ReadsCoco) {
  const auto pictures = read("coco.json", R"({"images": [{"id": 7, "file_name": "a.tif", "width": 200, "height": 100}],
"categories": [{"id": 3, "name": "pool"}],
"annotations": [{"id": 1, "image_id": 7, "category_id": 3, "bbox": [10, 20, 30, 5], "iscrowd": 0},
 {"id": 2, "image_id": 7, "category_id": 3, "bbox": [0, 0, 9, 9], "segmentation": [[0, 0, 9, 0, 9, 9]], "iscrowd": 1}]})");
  ASSERT_EQ(pictures.size(), 1U);
  expect_box(pictures[0].labels[0], 10, 20, 40, 25);
  EXPECT_TRUE(pictures[0].labels[0].box_alone);
  EXPECT_EQ(pictures[0].labels[1].outline_px.size(), 3U);
  EXPECT_FALSE(pictures[0].labels[1].box_alone);
  EXPECT_TRUE(pictures[0].labels[1].ignore);
}

TEST_F(AnnotatedPictureTest, ReadsYoloBoxesAndOutlines) {
  write("classes.txt", "car\r\ntank\r\n");
  const auto pictures = read("a.txt", "1 0.5 0.5 0.1 0.2\n\n0 0.1 0.1 0.2 0.1 0.2 0.2\n");
  ASSERT_EQ(pictures.size(), 1U);
  EXPECT_EQ(pictures[0].labels[0].class_name, "tank");
  expect_box(pictures[0].labels[0], 90, 40, 110, 60);
  EXPECT_EQ(pictures[0].labels[1].class_name, "car");
  EXPECT_NEAR((pictures[0].labels[1].outline_px[2] - Vector2d(40, 20)).norm(), 0, 1e-9);
  EXPECT_THAT(error("a.txt", "2 0.5 0.5 0.1 0.2\n"), HasSubstr("line 1: class 2 has no name; 2 are known"));
  EXPECT_THAT(error("a.txt", "1 0.5 0.5 0.1\n"), HasSubstr("line 1: is neither"));
  EXPECT_THAT(error("a.txt", "1 0.5 0.5 0.1 x\n"), HasSubstr("\"x\" is no number"));
  EXPECT_THAT(error("b.txt", ""), HasSubstr("no picture of its name"));
}

TEST_F(AnnotatedPictureTest, NamesWhatIsWrong) {
  const auto imglab = [&](const std::string& box) {
    return error("labels.xml", "<dataset><images><image file='a.tif'>" + box + "</image></images></dataset>");
  };
  EXPECT_THAT(imglab("<box top='1' left='1' width='0' height='5'><label>a</label></box>"),
              HasSubstr("labels.xml: a.tif, box 1: is a box without extent, 0 x 5 pixels"));
  EXPECT_THAT(
      imglab(
          "<box top='1' left='1' width='5' height='5'><part name='1' x='0' y='0'/><part name='01' x='1' y='1'/></box>"),
      HasSubstr("box 1: its part 01 is no place of a corner"));
  EXPECT_THAT(imglab("<box top='1' left='1' width='5'><label>a</label></box>"),
              HasSubstr("its attribute height: is missing"));
  EXPECT_THAT(error("labels.xml", "<dataset><images><image file='no.tif'/></images></dataset>"),
              HasSubstr("names the picture no.tif"));
  EXPECT_THAT(error("labels.xml", "<kml/>"), HasSubstr("neither imglab's <dataset> nor VOC's <annotation>"));
}

TEST_F(AnnotatedPictureTest, WhatIsWrittenReadsBack) {
  AnnotatedPicture picture;
  picture.picture = "a.tif";
  picture.labels.push_back({"a & b", circle_outline({50, 40}, 20), false, true, ""});
  picture.labels.push_back({"box", {{1, 2}, {11, 2}, {11, 8}, {1, 8}}, true, false, ""});
  const auto pictures = read("labels.xml", imglab_xml({picture}, "x < y"));
  ASSERT_EQ(pictures.size(), 1U);
  ASSERT_EQ(pictures[0].labels.size(), 2U);
  const PictureLabel& circle = pictures[0].labels[0];
  EXPECT_EQ(circle.class_name, "a & b");
  EXPECT_TRUE(circle.ignore);
  ASSERT_EQ(circle.outline_px.size(), 32U);
  for (std::size_t i = 0; i < 32; ++i) {
    EXPECT_LE((circle.outline_px[i] - picture.labels[0].outline_px[i]).lpNorm<Eigen::Infinity>(), 0.5 + 1e-9);
  }
  expect_box(pictures[0].labels[1], 1, 2, 11, 8);
  EXPECT_TRUE(pictures[0].labels[1].box_alone);
}

TEST_F(AnnotatedPictureTest, LargestPolygonOfCocoCountsAndSizesAreKept) {
  const auto pictures = read("coco.json",
                             "\xEF\xBB\xBF"
                             R"({"images": [{"id": 7, "file_name": "a.tif", "width": 200, "height": 99}],
"categories": [{"id": 3, "name": "pool"}], "annotations": [{"id": 1, "image_id": 7, "category_id": 3, "bbox": [0, 0, 1, 1],
 "segmentation": [[0, 0, 1, 0, 1, 1], [20, 20, 60, 20, 60, 50]]}]})");
  EXPECT_EQ(pictures[0].labels[0].outline_px.front(), Vector2d(20, 20));
  EXPECT_EQ(pictures[0].width_px, 200);
  EXPECT_EQ(pictures[0].height_px, 99);
}

TEST_F(AnnotatedPictureTest, ClassesNeedNoNamesWhereNobodyAsks) {
  const auto pictures = read_annotations(write("a.txt", "4 0.5 0.5 0.1 0.2\n"), "", false);
  EXPECT_EQ(pictures[0].labels[0].class_name, "");
  expect_box(pictures[0].labels[0], 90, 40, 110, 60);
}

TEST_F(AnnotatedPictureTest, ToldFromShapesByContent) {
  EXPECT_TRUE(is_annotation_file(write("a.txt", "")));
  EXPECT_TRUE(is_annotation_file(write("l.xml", "<dataset/>")));
  EXPECT_TRUE(is_annotation_file(write("l.xml", "<annotation/>")));
  EXPECT_TRUE(is_annotation_file(write("l.json", R"({"images": [], "annotations": []})")));
  EXPECT_FALSE(is_annotation_file(write("l.json", R"({"type": "FeatureCollection", "features": []})")));
  EXPECT_TRUE(is_annotation_file(write("l.json", "\xEF\xBB\xBF{\"images\": [], \"annotations\": []}")));
  EXPECT_FALSE(
      is_annotation_file(write("l.json", R"({"type": "FeatureCollection", "name": "<annotation", "features": []})")));
  EXPECT_FALSE(is_annotation_file(write("l.osm", "<?xml version='1.0'?><osm/>")));
}

}  // namespace
}  // namespace pilotage
