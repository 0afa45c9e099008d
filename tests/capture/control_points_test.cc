#include "pilotage/capture/control_points.h"

#include <fstream>

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

using pilotage::testing::error_of;
using pilotage::testing::TemporaryFolder;
using ::testing::HasSubstr;

const LocalFrame& lipno() {
  static const LocalFrame frame({15, 49.6});  // on the central meridian of zone 33
  return frame;
}

std::string write_list(const TemporaryFolder& folder, const std::string& text) {
  std::ofstream(folder / "gcp.txt") << text;
  return (folder / "gcp.txt").string();
}

TEST(ReadControlPoints, MarksOfOnePlaceAreOnePoint) {
  const TemporaryFolder folder;
  // 5494441.7 m is the northing of 49.6 N there; 100 m of the ground are 99.96 of the grid.
  const std::string list = write_list(folder,
                                      "EPSG:32633\n# a comment\n500000 5494500 310.5 12.5 99 a.jpg\r\n"
                                      "500000 5494500 310.5 40 17 photos/b.jpg\n\n500100 5494500 300 1 2 a.jpg north\n"
                                      "1 2 3 4 5 elsewhere.jpg\n");
  int unused_marks = 0;
  const auto points = read_control_points(list, {"a.jpg", "b.jpg"}, lipno(), unused_marks);
  ASSERT_EQ(points.size(), 2U);
  ASSERT_EQ(points[0].marks.size(), 2U);
  EXPECT_EQ(points[0].marks[1].frame, 1);
  EXPECT_EQ(points[0].marks[1].pixel, Eigen::Vector2d(40, 17));
  EXPECT_EQ(points[0].enu_m.z(), 310.5);
  EXPECT_EQ(points[1].name, "north");
  EXPECT_NEAR(points[1].enu_m.x() - points[0].enu_m.x(), 100 / 0.9996, 0.01);
  EXPECT_NEAR(points[0].enu_m.x(), 0, 1e-6);
  EXPECT_EQ(unused_marks, 1);
}

TEST(ReadControlPoints, WhatIsWrongIsNamed) {
  const TemporaryFolder folder;
  int unused = 0;
  const auto message = [&](const std::string& text) {
    return error_of<DataError>([&] { read_control_points(write_list(folder, text), {"a.jpg"}, lipno(), unused); });
  };
  EXPECT_THAT(message("no CRS\n1 2 3 4 5 a.jpg\n"), HasSubstr("line 1 is to name the points' CRS"));
  EXPECT_THAT(message("WGS84 UTM 99N\n"), HasSubstr("is no UTM zone"));
  EXPECT_THAT(message("WGS84 UTM 33N\n1 2 3\n"), HasSubstr("line 2: is to have x, y, z, column, row and file"));
  EXPECT_THAT(message("WGS84 UTM 33N\n500000 5494500 high 4 5 a.jpg\n"), HasSubstr("line 2: z \"high\" is no number"));
  EXPECT_THAT(message("WGS84 UTM 33N\n500000 5494500 3 4 5 a.jpg P\n500001 5494500 3 4 5 a.jpg P\n"),
              HasSubstr("line 3: point \"P\" stands at two places, 1.000 m apart"));
  EXPECT_THAT(message("WGS84 UTM 33N\n500000 5494500 3 4 5 b.jpg\n"), HasSubstr("holds no mark in any of the frames"));
}

}  // namespace
}  // namespace pilotage
