#include "pilotage/mission/frame_table.h"

#include <cmath>

#include "testing/error_of.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::string kNames =
    "file,time_s,prior_lon_deg,prior_lat_deg,prior_sigma_m,height_agl_m,yaw_deg,pitch_deg,roll_deg";
const std::string kRow = "a.jpg,1.5,16.25,-55.5,30,120,152,1.5,-0.8";

FrameTable read(const std::string& text, const FrameTableOptions& options = {}) {
  return frame_table_from_csv("frames.csv", text, options);
}

std::string frame_table_error(const std::string& text, const FrameTableOptions& options = {}) {
  return testing::error_of<DataError>([&] { read(text, options); });
}

/// The row with one of its cells, counted from 0, replaced.
std::string row_with(std::size_t index, const std::string& cell) {
  std::string row;
  std::size_t place = 0;
  for (std::size_t begin = 0; begin <= kRow.size(); ++place) {
    const std::size_t end = std::min(kRow.find(',', begin), kRow.size());
    row += (place > 0 ? "," : "") + (place == index ? cell : kRow.substr(begin, end - begin));
    begin = end + 1;
  }
  return row;
}

TEST(FrameTable, ReadsEveryColumn) {
  const FrameTable table = read(kNames + "\n" + kRow + "\n\"b, c.jpg\",2,190,10,1,2,3,4,5\n");
  EXPECT_THAT(table.warnings, IsEmpty());
  ASSERT_EQ(table.frames.size(), 2u);
  const FrameRecord& frame = table.frames[0];
  EXPECT_EQ(frame.file, "a.jpg");
  EXPECT_EQ(frame.time_s, 1.5);
  EXPECT_EQ(frame.prior.lon_deg, 16.25);
  EXPECT_EQ(frame.prior.lat_deg, -55.5);
  EXPECT_EQ(frame.prior_covariance_en_m2, isotropic_covariance_m2(30));
  EXPECT_EQ(frame.height_agl_m, 120);
  EXPECT_EQ(frame.attitude.yaw_deg, 152);
  EXPECT_EQ(frame.attitude.pitch_deg, 1.5);
  EXPECT_EQ(frame.attitude.roll_deg, -0.8);
  EXPECT_FALSE(frame.truth());
  EXPECT_EQ(table.frames[1].file, "b, c.jpg");
  EXPECT_EQ(table.frames[1].prior.lon_deg, -170) << "longitudes are brought into [-180, 180)";
}

TEST(FrameTable, ColumnsStandInAnyOrder) {
  const FrameTable table = read(
      "\xEF\xBB\xBFroll_deg,yaw_deg,pitch_deg,height_agl_m,prior_sigma_m,prior_lat_deg,prior_lon_deg,time_s,file\r\n"
      "7,6,5,4,3,2,1,0,z.png\r\n");
  ASSERT_EQ(table.frames.size(), 1u);
  EXPECT_EQ(table.frames[0].file, "z.png");
  EXPECT_EQ(table.frames[0].attitude.roll_deg, 7);
  EXPECT_EQ(table.frames[0].attitude.yaw_deg, 6);
  EXPECT_EQ(table.frames[0].prior.lon_deg, 1);
}

TEST(FrameTable, APriorMayHaveAWholeCovariance) {
  const std::string names =
      "file,time_s,prior_lon_deg,prior_lat_deg,prior_east_sigma_m,prior_north_sigma_m,prior_covariance_en_m2,"
      "height_agl_m,yaw_deg,pitch_deg,roll_deg\n";
  const FrameTable table = read(names + "a.jpg,0,1,2,3,4,-6,50,0,0,0\n");
  EXPECT_THAT(table.warnings, IsEmpty());
  EXPECT_EQ(table.frames[0].prior_covariance_en_m2, (Eigen::Matrix2d() << 9, -6, -6, 16).finished());
  EXPECT_EQ(frame_table_error(names + "a.jpg,0,1,2,3,4,12.5,50,0,0,0\n"),
            "frames.csv: line 2: prior_covariance_en_m2 = 12.5 is more than prior_east_sigma_m times "
            "prior_north_sigma_m, 12");
  EXPECT_EQ(frame_table_error("prior_sigma_m," + names + "1,a.jpg,0,1,2,3,4,0,50,0,0,0\n"),
            "frames.csv: line 1: columns \"prior_sigma_m\" and \"prior_east_sigma_m\" … exclude each other");
  EXPECT_THAT(frame_table_error("file,prior_east_sigma_m,prior_covariance_en_m2\na,1,0\n"),
              ::testing::StartsWith("frames.csv: line 1: column \"prior_north_sigma_m\" is missing"));
  const FrameTableOptions partly{FrameTruth::kCenter, FrameColumns::kFileOnly};
  EXPECT_FALSE(read(names + "a.jpg,,,,,,,,,,\n", partly).frames[0].prior_covariance_en_m2.allFinite());
}

TEST(FrameTable, UnknownColumnsAreToldOf) {
  const FrameTable table = read(kNames + ",gust_mps,true_lon_dec,true_yaw_deg\n" + kRow + ",anything,\"at, all\",x\n");
  EXPECT_THAT(table.warnings,
              ElementsAre("frames.csv: line 1: column \"gust_mps\" is not known and not used",
                          "frames.csv: line 1: column \"true_lon_dec\" is not known and not used; is it "
                          "\"true_lon_deg\"?"));
}

TEST(FrameTable, TruthIsOfTheCentreOrTheNadir) {
  const std::string both = kNames + ",true_lon_deg,true_lat_deg,true_nadir_lon_deg,true_nadir_lat_deg\n" + kRow +
                           ",1,2,3,4\n" + kRow + ",1,2,,\n" + kRow + ",,,3,4\n";
  for (const FrameTruth truth : {FrameTruth::kCenter, FrameTruth::kNadir}) {
    const auto frames = read(both, {truth, FrameColumns::kAll}).frames;
    EXPECT_EQ(frames[0].true_center->lon_deg, 1) << "beside the nadir's columns these are the centre's";
    EXPECT_EQ(frames[0].true_nadir->lat_deg, 4);
    EXPECT_EQ(frames[0].truth()->lon_deg, 3) << "what is judged is the aircraft's own place";
    EXPECT_FALSE(frames[1].true_nadir);
    EXPECT_EQ(frames[1].truth()->lon_deg, 1);
    EXPECT_FALSE(frames[2].true_center);
  }
  const std::string one = kNames + ",true_lon_deg,true_lat_deg\n" + kRow + ",1,2\n";
  const auto nadir = read(one, {FrameTruth::kNadir, {}}).frames;
  EXPECT_EQ(nadir[0].true_nadir->lon_deg, 1) << "with one pair of columns the caller says what it is";
  EXPECT_FALSE(nadir[0].true_center);
  const auto center = read(one, {FrameTruth::kCenter, {}}).frames;
  EXPECT_EQ(center[0].true_center->lon_deg, 1);
  EXPECT_FALSE(center[0].true_nadir);
}

TEST(FrameTable, HalfATruthIsRefused) {
  EXPECT_EQ(frame_table_error(kNames + ",true_lon_deg,true_lat_deg\n" + kRow + ",1,\n"),
            "frames.csv: line 2: true_lon_deg is given, true_lat_deg is not");
  EXPECT_EQ(frame_table_error(kNames + ",true_lat_deg\n" + kRow + ",1\n"),
            "frames.csv: line 2: true_lat_deg is given, true_lon_deg is not");
}

TEST(FrameTable, EveryColumnIsNeeded) {
  EXPECT_EQ(frame_table_error("file,time_s\na,1\n"),
            "frames.csv: line 1: column \"prior_lon_deg\" is missing; the columns are file, time_s");
  EXPECT_EQ(frame_table_error("time_s\n1\n", {FrameTruth::kCenter, FrameColumns::kFileOnly}),
            "frames.csv: line 1: column \"file\" is missing; the columns are time_s");
}

TEST(FrameTable, FileAloneIsEnoughWhenAskedFor) {
  const auto frames = read("file,yaw_deg\na.jpg,\nb.jpg,3\n", {FrameTruth::kCenter, FrameColumns::kFileOnly}).frames;
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_TRUE(std::isnan(frames[0].attitude.yaw_deg));
  EXPECT_TRUE(std::isnan(frames[0].prior.lon_deg));
  EXPECT_EQ(frames[1].attitude.yaw_deg, 3);
}

TEST(FrameTable, BadCellsAreNamedWithWhatIsAllowed) {
  const auto error_with = [](std::size_t index, const std::string& cell) {
    return frame_table_error(kNames + "\n" + row_with(index, cell) + "\n");
  };
  EXPECT_EQ(error_with(0, ""), "frames.csv: line 2: file is empty");
  EXPECT_EQ(error_with(1, "inf"), "frames.csv: line 2: time_s = \"inf\" is not a number");
  EXPECT_EQ(error_with(2, "361"), "frames.csv: line 2: prior_lon_deg = \"361\" is not a number in [-180, 360]");
  EXPECT_EQ(error_with(3, "-90.5"), "frames.csv: line 2: prior_lat_deg = \"-90.5\" is not a number in [-90, 90]");
  EXPECT_EQ(error_with(4, "-1"), "frames.csv: line 2: prior_sigma_m = \"-1\" is not a number in [0, 1e+05]");
  EXPECT_EQ(error_with(5, "1e9"), "frames.csv: line 2: height_agl_m = \"1e9\" is not a number in [-1000, 1e+05]");
  EXPECT_EQ(error_with(6, "nan"), "frames.csv: line 2: yaw_deg = \"nan\" is not a number in [-360, 360]");
  EXPECT_EQ(error_with(7, "1,5"), "frames.csv: line 2: 10 cells, expected 9");
  EXPECT_EQ(error_with(7, " 1"), "frames.csv: line 2: pitch_deg = \" 1\" is not a number in [-360, 360]");
  EXPECT_EQ(error_with(8, ""), "frames.csv: line 2: roll_deg = \"\" is not a number in [-360, 360]");
}

TEST(FrameTable, TablesThatAreNoneAreRefused) {
  EXPECT_EQ(frame_table_error(""), "frames.csv: empty, expected a table of frames");
  EXPECT_EQ(frame_table_error(kNames + "\n"), "frames.csv: has no frame, only a line of names");
  EXPECT_EQ(frame_table_error(kNames + ",file\n" + kRow + ",b\n"),
            "frames.csv: line 1: column \"file\" is a duplicate");
}

/// No prefix of a table, and no table with some bytes changed, may do worse than a DataError.
TEST(FrameTable, SurvivesAnyBytes) {
  const std::string csv =
      kNames + ",true_lon_deg,true_lat_deg\r\n\"x, \"\"y\"\".jpg\",1,2,3,4,5,6,7,8,9,10\r\n" + kRow + ",,\n";
  ASSERT_EQ(frame_table_error(csv), "");
  for (std::size_t size = 0; size < csv.size(); ++size) frame_table_error(csv.substr(0, size));
  Random random(seed_from_name("FrameTable.SurvivesAnyBytes"));
  constexpr std::string_view kNasty = ",\"\r\n\0e-x";
  for (int trial = 0; trial < 3000; ++trial) {
    std::string text = csv;
    for (std::uint64_t i = random.below(4); i > 0; --i) {
      text[random.below(text.size())] =
          i % 2 == 0 ? kNasty[random.below(kNasty.size())] : static_cast<char>(random.below(256));
    }
    const FrameTableOptions options{random.below(2) == 0 ? FrameTruth::kCenter : FrameTruth::kNadir,
                                    random.below(2) == 0 ? FrameColumns::kAll : FrameColumns::kFileOnly};
    frame_table_error(text, options);
  }
}

TEST(FrameTable, FramesLieBesideTheirTable) {
  EXPECT_EQ(frame_path("flight/frames.csv", "a/b.jpg"), "flight/a/b.jpg");
  EXPECT_EQ(frame_path("frames.csv", "b.jpg"), "b.jpg");
  EXPECT_EQ(frame_path("flight/frames.csv", "/vsizip/f.zip/b.jpg"), "/vsizip/f.zip/b.jpg");
}

}  // namespace
}  // namespace pilotage
