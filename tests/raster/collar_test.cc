#include "pilotage/raster/collar.h"

#include <cmath>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "raster/raster_maker.h"
#include "testing/read_all.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::make_raster;
using testing::RasterSpec;
using testing::read_all;
using testing::TemporaryFolder;
using testing::utm33;

constexpr int kSide = 400;

/// A square of ground, turned by 30° within its raster as gdalwarp leaves it: `collar_value` in the four corners. The
/// ground holds all values but 0, and one black and one white pond of 40 x 40 px in its middle.
RasterSpec turned_ground(double collar_value, int bands = 1) {
  RasterSpec spec;
  spec.width = spec.height = kSide;
  spec.bands = bands;
  spec.creation_options = {"TILED=YES", "BLOCKXSIZE=64", "BLOCKYSIZE=64"};
  spec.value = [collar_value](int band, int col, int row) -> double {
    const double x = col - kSide / 2.0 + 0.5;
    const double y = row - kSide / 2.0 + 0.5;
    const double turned_x = 0.866 * x + 0.5 * y;
    const double turned_y = -0.5 * x + 0.866 * y;
    constexpr double kHalf = kSide / 2.0 / 1.366;
    if (std::abs(turned_x) > kHalf || std::abs(turned_y) > kHalf) return collar_value;
    if (std::abs(x - 30) < 20 && std::abs(y) < 20) return 0;
    if (std::abs(x + 30) < 20 && std::abs(y) < 20) return 255;
    return 1 + (band * 50 + col * 3 + row * 7) % 250;
  };
  return spec;
}

/// 255 where the ground of turned_ground lies.
cv::Mat ground_of(const RasterSpec& spec) {
  cv::Mat valid(kSide, kSide, CV_8U);
  const RasterSpec marked = turned_ground(-1);
  for (int row = 0; row < spec.height; ++row) {
    for (int col = 0; col < spec.width; ++col) {
      valid.at<std::uint8_t>(row, col) = marked.value(0, col, row) < 0 ? 0 : 255;
    }
  }
  return valid;
}

int differing(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() ? cv::countNonZero(a != b) : -1;
}

/// Pixels of `colors` (CV_8U) that a flood from the edge reaches, by regions, sorted out by the two thresholds.
cv::Mat flooded(const cv::Mat& colors) {
  cv::Mat collar = cv::Mat::zeros(colors.size(), CV_8U);
  cv::Mat seen = cv::Mat::zeros(colors.size(), CV_8U);
  for (int row = 0; row < colors.rows; ++row) {
    for (int col = 0; col < colors.cols; ++col) {
      const std::uint8_t color = colors.at<std::uint8_t>(row, col);
      if (color == 0 || seen.at<std::uint8_t>(row, col) != 0) continue;
      std::vector<cv::Point> region{{col, row}};
      seen.at<std::uint8_t>(row, col) = 1;
      std::int64_t edge = 0;
      for (std::size_t i = 0; i < region.size(); ++i) {
        const cv::Point at = region[i];
        if (at.y == 0 || at.y == colors.rows - 1) {
          edge += 1;
        } else {
          edge += (at.x == 0) + (at.x == colors.cols - 1);
        }
        for (const cv::Point step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
          const cv::Point to = at + step;
          if (!cv::Rect({}, colors.size()).contains(to)) continue;
          if (colors.at<std::uint8_t>(to) != color || seen.at<std::uint8_t>(to) != 0) continue;
          seen.at<std::uint8_t>(to) = 1;
          region.push_back(to);
        }
      }
      const auto pixels = static_cast<std::int64_t>(region.size());
      if (edge == 0 || pixels < kLeastCollarPixels || pixels < kLeastCollarDepth_px * edge) continue;
      for (const cv::Point& at : region) collar.at<std::uint8_t>(at) = 255;
    }
  }
  return collar;
}

std::optional<Collar> collar_of(const cv::Mat& colors) {
  CollarSearch search(colors.cols, colors.rows);
  for (int row = 0; row < colors.rows; ++row) {
    const auto* first = colors.ptr<CollarColor>(row);
    EXPECT_TRUE(search.add_row({first, first + colors.cols}));
  }
  return search.finish();
}

TEST(CollarSearch, IsAFloodFromTheEdge) {
  Random random(seed_from_name("CollarSearch.IsAFloodFromTheEdge"));
  int with_collar = 0;
  for (int round = 0; round < 40; ++round) {
    const int width = 150 + static_cast<int>(random.uniform(0, 100));
    const int height = 150 + static_cast<int>(random.uniform(0, 100));
    // Blobs of both colours that wind, touch one another, the edge and themselves.
    cv::Mat colors = cv::Mat::zeros(height, width, CV_8U);
    for (int blob = 0; blob < 30; ++blob) {
      const cv::Point center(static_cast<int>(random.uniform(-20, width + 20)),
                             static_cast<int>(random.uniform(-20, height + 20)));
      cv::Rect box(center, cv::Size(static_cast<int>(random.uniform(2, 90)), static_cast<int>(random.uniform(2, 90))));
      box &= cv::Rect(0, 0, width, height);
      if (!box.empty()) colors(box).setTo(blob % 3);
    }
    for (int speck = 0; speck < 500; ++speck) {
      colors.at<std::uint8_t>(static_cast<int>(random.uniform(0, height)), static_cast<int>(random.uniform(0, width))) =
          static_cast<std::uint8_t>(speck % 3);
    }
    const cv::Mat expected = flooded(colors);
    const std::optional<Collar> collar = collar_of(colors);
    ASSERT_EQ(collar.has_value(), cv::countNonZero(expected) > 0) << "round " << round;
    if (!collar) continue;
    ++with_collar;
    cv::Mat valid(height, width, CV_8U, cv::Scalar(255));
    collar->clear({0, 0, width, height}, valid);
    EXPECT_EQ(differing(255 - valid, expected), 0) << "round " << round;
    EXPECT_EQ(collar->black_px + collar->white_px, cv::countNonZero(expected));
    cv::Mat part(50, 60, CV_8U, cv::Scalar(255));
    collar->clear({70, 80, 60, 50}, part);
    EXPECT_EQ(differing(part, valid(cv::Rect(70, 80, 60, 50))), 0);
  }
  EXPECT_GT(with_collar, 10);
}

TEST(CollarSearch, TinyAndThinRegionsAreNone) {
  const auto with_corner = [](int width, int height) {
    cv::Mat colors = cv::Mat::zeros(1000, 1000, CV_8U);
    colors(cv::Rect(0, 0, width, height)).setTo(static_cast<int>(CollarColor::kBlack));
    return collar_of(colors).has_value();
  };
  EXPECT_TRUE(with_corner(64, 64));
  EXPECT_FALSE(with_corner(64, 63));  // 4032 pixels
  EXPECT_TRUE(with_corner(1000, 9));  // 8.8 for each of 1016 pixels of the edge
  EXPECT_FALSE(with_corner(1000, 7));
}

TEST(CollarSearch, GivesUpWhereTheImageIsRagged) {
  CollarSearch search(100, 100, 1000);
  std::vector<CollarColor> row(100);
  for (std::size_t i = 0; i < row.size(); i += 2) row[i] = CollarColor::kBlack;
  int rows = 0;
  while (search.add_row(row)) ++rows;
  EXPECT_EQ(rows, 20);
}

struct CollarCase {
  GDALDataType type;
  int bands;
  double value;
  const char* color;
};

class CollarOf : public ::testing::TestWithParam<CollarCase> {};

TEST_P(CollarOf, IsNoGround) {
  const TemporaryFolder folder;
  const CollarCase& c = GetParam();
  RasterSpec spec = turned_ground(c.value, c.bands);
  spec.type = c.type;
  const std::string path = make_raster(folder / "a.tif", spec);
  const ImageryInfo info = inspect_imagery(path);
  EXPECT_THAT(info.warnings, ElementsAre(AllOf(HasSubstr(path), HasSubstr("46.4 % of its pixels"), HasSubstr(c.color),
                                               HasSubstr("--nodata"), HasSubstr("--collar keep"))));
  const cv::Mat ground = ground_of(spec);
  EXPECT_EQ(differing(read_all(open_gray(path)).valid, ground), 0);
  EXPECT_EQ(differing(open_colors(path).read({0, 0, kSide, kSide}).valid, ground), 0);
  const Raster part = open_gray(path).read({10, 90, 70, 200});
  EXPECT_EQ(differing(part.valid, ground(cv::Rect(10, 90, 70, 200))), 0);

  ImageryOptions keep;
  keep.collar = CollarRule::kKeep;
  EXPECT_THAT(inspect_imagery(path, keep).warnings, IsEmpty());
  EXPECT_EQ(cv::countNonZero(read_all(open_gray(path, keep)).valid), kSide * kSide);
}

INSTANTIATE_TEST_SUITE_P(Types, CollarOf,
                         ::testing::Values(CollarCase{GDT_Byte, 1, 0, "black"}, CollarCase{GDT_Byte, 3, 0, "black"},
                                           CollarCase{GDT_Byte, 3, 255, "white"}, CollarCase{GDT_UInt16, 3, 0, "black"},
                                           CollarCase{GDT_UInt16, 1, 65535, "white"},
                                           CollarCase{GDT_Float32, 1, 0, "black"}));

// What --nodata 0 would say of the same raster (its pond aside) is what the collar says, on a grid of any scale, and
// the collar's black does not mix into the ground beside it.
TEST(GrayOnGrid, ACollarNeverMixesIntoItsNeighbours) {
  const TemporaryFolder folder;
  const auto ground = [](int, int col, int row) -> double {
    return turned_ground(0).value(0, col, row) == 0 ? 0 : 100;
  };
  RasterSpec spec = turned_ground(0);
  spec.value = [&](int band, int col, int row) {
    return std::hypot(col - 200, row - 200) < 80 ? 100 : ground(band, col, row);
  };
  const std::string without_overviews = make_raster(folder / "said.tif", spec);
  const std::string path = make_raster(folder / "a.tif", spec);
  testing::change_raster(path, [](GDALDataset& dataset) {
    int level = 2;
    dataset.BuildOverviews("AVERAGE", 1, &level, 0, nullptr, nullptr, nullptr);
  });
  ImageryOptions nodata;
  nodata.nodata = 0;
  for (const double gsd_m : {0.4, 0.5, 0.8, 1.7}) {
    const auto side = static_cast<std::int64_t>(200 / gsd_m);
    const GeoTransform place = GeoTransform::north_up(500000.1, 5'000'000.2, gsd_m);
    const Raster collar = read_all(open_gray_on_grid({path}, utm33(), place, side, side));
    const Raster said = read_all(open_gray_on_grid({without_overviews}, utm33(), place, side, side, nodata));
    EXPECT_EQ(differing(collar.valid, said.valid), 0) << gsd_m;
    EXPECT_GT(cv::countNonZero(collar.valid), side * side / 3);
    EXPECT_EQ(cv::countNonZero((collar.pixels != 100) & collar.valid), 0) << gsd_m;
    EXPECT_EQ(differing(read_all(open_valid_on_grid({path}, utm33(), place, side, side)).valid, collar.valid), 0);
    const GrayAndColors both = open_gray_and_colors_on_grid({path}, utm33(), place, side, side, {}, 1 << 20);
    EXPECT_EQ(differing(read_all(both.gray).valid, collar.valid), 0);
  }
}

TEST(Collar, IsNotLookedForWhereTheFileSaysWhatIsGround) {
  const TemporaryFolder folder;
  RasterSpec spec = turned_ground(0);
  spec.finish = [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(7); };
  const std::string path = make_raster(folder / "nodata.tif", spec);
  EXPECT_THAT(inspect_imagery(path).warnings, IsEmpty());
  EXPECT_EQ(inspect_imagery(path).collar, nullptr);
  ImageryOptions nodata;
  nodata.nodata = 0;
  EXPECT_EQ(inspect_imagery(make_raster(folder / "a.tif", turned_ground(0)), nodata).collar, nullptr);
}

TEST(Collar, HeightsOfZeroAreHeights) {
  const TemporaryFolder folder;
  RasterSpec spec = turned_ground(0);
  spec.type = GDT_Float32;
  const Elevation elevation(make_raster(folder / "a.tif", spec));
  EXPECT_EQ(elevation.amsl_m(*CrsTransform(utm33()).geodetic_from_map(Eigen::Vector2d(500005, 4999995))), 0);
}

TEST(Collar, FollowsAChangedFile) {
  const TemporaryFolder folder;
  const std::string path = make_raster(folder / "a.tif", turned_ground(0));
  EXPECT_NE(inspect_imagery(path).collar, nullptr);
  std::filesystem::remove(path);
  RasterSpec bare = turned_ground(0);
  bare.value = [](int, int col, int row) { return 1 + (col + row) % 200; };
  bare.width = 390;
  make_raster(path, bare);
  EXPECT_EQ(inspect_imagery(path).collar, nullptr);
}

// Lossy compression keeps blocks that are black all over, and leaves a fringe of almost black where ground and collar
// share a block.
TEST(Collar, OfAJpegLeavesAFringeOfABlock) {
  const TemporaryFolder folder;
  RasterSpec spec = turned_ground(0, 3);
  spec.creation_options = {"COMPRESS=JPEG", "PHOTOMETRIC=YCBCR", "JPEG_QUALITY=85", "INTERLEAVE=PIXEL"};
  const std::string path = make_raster(folder / "a.tif", spec);
  const cv::Mat valid = read_all(open_gray(path)).valid;
  const cv::Mat ground = ground_of(spec);
  const cv::Mat two_blocks = cv::Mat::ones(33, 33, CV_8U);
  cv::Mat near_ground;
  cv::dilate(ground, near_ground, two_blocks);
  EXPECT_EQ(cv::countNonZero(valid & ~near_ground), 0);
  cv::Mat inside;
  cv::erode(ground, inside, two_blocks);
  EXPECT_EQ(cv::countNonZero(inside & ~valid), 0);
}

}  // namespace
}  // namespace pilotage
