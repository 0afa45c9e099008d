#include "pilotage/report/display_plane.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/geo/local_frame.h"

namespace pilotage {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Mercator, KnownPoints) {
  // The square of web maps: 180° is π·6,378,137 m, and so is the latitude 85.0511287798066°, which lies just beyond our
  // limit.
  EXPECT_NEAR(mercator_from_geodetic({180, 0}).x(), 20037508.342789, 1e-5);
  EXPECT_NEAR(mercator_from_geodetic({0, 0}).y(), 0, 1e-9);
  EXPECT_NEAR(mercator_from_geodetic({0, 45}).y(), 6378137 * std::log(std::tan(kPi / 4 + kPi / 8)), 1e-6);
  EXPECT_NEAR(mercator_from_geodetic({0, -45}).y(), -5621521.486192, 1e-5);
  EXPECT_TRUE(std::isnan(mercator_from_geodetic({0, 85.2}).y()));
}

TEST(DisplayGrid, HasSquarePixelsAroundTheBounds) {
  const DisplayGrid grid = display_grid({0, 0, 1000, 333}, 500);
  EXPECT_EQ(grid.width_px, 500);
  EXPECT_EQ(grid.height_px, 167);
  EXPECT_DOUBLE_EQ(grid.pixel_m, 2);
  EXPECT_NEAR(grid.edges_m.height_m(), 334, 1e-9);
  EXPECT_NEAR(grid.edges_m.min_y_m, -0.5, 1e-9);
  EXPECT_EQ(display_grid({0, 0, 1000, 0}, 500).height_px, 1);
}

// A turned local grid at 70° north, across the antimeridian, 40 km wide: pixel by pixel against the function itself.
TEST(MapFromDisplay, InvertsTheFunctionToAQuarterPixel) {
  const LocalFrame frame({179.9, 70});
  const auto geodetic = [&](Eigen::Vector2d xy) {
    return frame.geodetic_from_enu({0.8 * xy.x() + 0.6 * xy.y(), -0.6 * xy.x() + 0.8 * xy.y(), 0});
  };
  const auto display = mercator_from_map(geodetic, 179.9);
  Bounds bounds;
  for (const double x : {-20000.0, 20000.0}) {
    for (const double y : {-20000.0, 20000.0}) bounds.extend(display({x, y}));
  }
  EXPECT_GT(bounds.max_x_m, 20037508);  // in one piece, beyond 180°
  const DisplayGrid grid = display_grid(bounds, 800);
  const cv::Mat map_xy = map_from_display(grid, display, {0, 0});
  double largest_px = 0;
  for (int row = 0; row < grid.height_px; row += 7) {
    for (int col = 0; col < grid.width_px; col += 7) {
      const auto& xy = map_xy.at<cv::Vec2d>(row, col);
      const Eigen::Vector2d got = display({xy[0], xy[1]});
      const Eigen::Vector2d wanted(grid.edges_m.min_x_m + (col + 0.5) * grid.pixel_m,
                                   grid.edges_m.max_y_m - (row + 0.5) * grid.pixel_m);
      largest_px = std::max(largest_px, (got - wanted).norm() / grid.pixel_m);
    }
  }
  EXPECT_LT(largest_px, 0.3);
}

TEST(MapFromDisplay, WhereThereIsNoImageItIsNan) {
  const auto display = [](const Eigen::Vector2d& xy) -> Eigen::Vector2d {
    if (xy.x() > 150) return {std::nan(""), std::nan("")};
    return xy;
  };
  const cv::Mat map_xy = map_from_display(display_grid({0, 0, 200, 100}, 200), display, {10, 10});
  EXPECT_NEAR(map_xy.at<cv::Vec2d>(99, 0)[0], 0.5, 0.01);
  EXPECT_NEAR(map_xy.at<cv::Vec2d>(99, 0)[1], 0.5, 0.01);
  EXPECT_TRUE(std::isnan(map_xy.at<cv::Vec2d>(50, 199)[0]));
}

Raster square_at(int col, int row) {
  Raster raster;
  raster.pixels = cv::Mat(400, 400, CV_8UC3, cv::Scalar(20, 40, 60));
  raster.valid = cv::Mat(400, 400, CV_8UC1, cv::Scalar(255));
  raster.pixels(cv::Rect(col, row, 40, 40)).setTo(cv::Scalar(250, 10, 10));
  raster.map_from_pixel = GeoTransform::north_up(0, 400, 1);
  return raster;
}

Eigen::Vector2d red_center(const cv::Mat& picture) {
  Eigen::Vector2d sum(0, 0);
  double count = 0;
  for (int row = 0; row < picture.rows; ++row) {
    for (int col = 0; col < picture.cols; ++col) {
      if (picture.at<cv::Vec3b>(row, col)[0] < 150) continue;
      sum += Eigen::Vector2d(col + 0.5, row + 0.5);
      ++count;
    }
  }
  return sum / count;
}

TEST(WarpImagery, PutsTheGroundWhereItLies) {
  const auto identity = [](const Eigen::Vector2d& xy) { return xy; };
  for (const int side_px : {800, 400, 100}) {  // finer than the imagery, equal, four times coarser
    const DisplayGrid grid = display_grid({0, 0, 400, 400}, side_px);
    const cv::Mat picture = warp_imagery(square_at(100, 280), map_from_display(grid, identity, {0, 0}));
    const Eigen::Vector2d center = red_center(picture) * grid.pixel_m;
    EXPECT_NEAR(center.x(), 120, 0.6) << side_px;
    EXPECT_NEAR(center.y(), 300, 0.6) << side_px;
  }
}

TEST(WarpImagery, GroundWithoutImageryTakesTheBackground) {
  Raster raster = square_at(0, 0);
  raster.valid(cv::Rect(0, 0, 200, 400)).setTo(0);
  raster.pixels(cv::Rect(0, 0, 200, 400)).setTo(cv::Scalar(1, 1, 1));
  const auto identity = [](const Eigen::Vector2d& xy) { return xy; };
  for (const int side_px : {150, 600}) {
    const DisplayGrid grid = display_grid({-100, 0, 500, 400}, side_px);
    const cv::Mat picture = warp_imagery(raster, map_from_display(grid, identity, {0, 0}));
    const int row = picture.rows / 2;
    EXPECT_EQ(picture.at<cv::Vec3b>(row, 2), cv::Vec3b(0xd9, 0xdd, 0xe1)) << "outside the imagery";
    EXPECT_EQ(picture.at<cv::Vec3b>(row, picture.cols / 3), cv::Vec3b(0xd9, 0xdd, 0xe1)) << "masked";
    EXPECT_EQ(picture.at<cv::Vec3b>(row, picture.cols * 2 / 3), cv::Vec3b(20, 40, 60)) << "valid";
  }
}

TEST(WarpImagery, GrayImageryBecomesColour) {
  Raster raster = square_at(0, 0);
  raster.pixels = cv::Mat(400, 400, CV_8UC1, cv::Scalar(77));
  const auto identity = [](const Eigen::Vector2d& xy) { return xy; };
  const cv::Mat picture = warp_imagery(raster, map_from_display(display_grid({0, 0, 400, 400}, 64), identity, {0, 0}));
  EXPECT_EQ(picture.at<cv::Vec3b>(30, 30), cv::Vec3b(77, 77, 77));
}

TEST(EncodeJpeg, KeepsColourOrderAndLimit) {
  cv::Mat rgb(300, 300, CV_8UC3, cv::Scalar(200, 30, 10));
  std::string bytes = encode_jpeg(rgb, 1000000);
  const cv::Mat bgr = cv::imdecode(std::vector<char>(bytes.begin(), bytes.end()), cv::IMREAD_COLOR);
  EXPECT_NEAR(bgr.at<cv::Vec3b>(150, 150)[2], 200, 6);
  EXPECT_NEAR(bgr.at<cv::Vec3b>(150, 150)[0], 10, 6);
  cv::RNG(1).fill(rgb, cv::RNG::UNIFORM, 0, 256);
  const std::size_t best = encode_jpeg(rgb, 1000000).size();
  EXPECT_LE(encode_jpeg(rgb, best * 3 / 4).size(), best * 3 / 4);
}

}  // namespace
}  // namespace pilotage
