#include "pilotage/registration/warped_source.h"

#include <cmath>

#include "registration/two_dates.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/registration/fit_warp.h"

namespace pilotage {
namespace {

using testing::make_two_dates;
using testing::TwoDates;

constexpr int kWarpedSide_px = 700;

Eigen::Vector2d wavy_field(const Eigen::Vector2d& p) {
  return {7 + 5 * std::sin((p.x() - 1000) / 200), -4 + 3 * std::cos(p.y() / 180)};
}

std::shared_ptr<const WarpField> fitted() {
  std::vector<Tie> ties;
  for (double x = 1020; x < 1680; x += 20) {
    for (double y = 4320; y < 4980; y += 20) {
      Tie tie;
      tie.point_m = {x, y};
      tie.displacement_m = wavy_field(tie.point_m);
      tie.ncc = 0.9;
      ties.push_back(tie);
    }
  }
  return std::make_shared<const WarpField>(fit_warp(ties, 1, {}).field);
}

TEST(WarpedSource, DrawsTheSecondDateOntoTheReference) {
  const TwoDates dates = make_two_dates(kWarpedSide_px, wavy_field, "warped");
  const GraySource warped = warped_source(gray_source_from(dates.second), fitted());
  const Raster drawn = warped.read({50, 50, 600, 600});
  EXPECT_EQ(cv::countNonZero(drawn.valid), 600 * 600);
  cv::Mat difference;
  cv::absdiff(drawn.pixels, dates.reference.pixels(cv::Rect(50, 50, 600, 600)), difference);
  EXPECT_LT(cv::mean(difference)[0], 1.0);
  EXPECT_EQ(drawn.map_from_pixel, warped.map_from_pixel.shifted(50, 50));
}

TEST(WarpedSource, ValuesDoNotDependOnTheWindow) {
  const TwoDates dates = make_two_dates(kWarpedSide_px, wavy_field, "windows");
  const GraySource warped = warped_source(gray_source_from(dates.second), fitted());
  const Raster all = warped.read({0, 0, kWarpedSide_px, kWarpedSide_px});
  for (const PixelWindow& window : {PixelWindow{0, 0, 5, 5}, {13, 17, 600, 40}, {505, 490, 30, 60}, {699, 699, 1, 1}}) {
    const Raster part = warped.read(window);
    const cv::Rect rect(static_cast<int>(window.col), static_cast<int>(window.row), window.width, window.height);
    EXPECT_EQ(cv::norm(part.valid, all.valid(rect), cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(part.pixels, all.pixels(rect), cv::NORM_INF), 0);
  }
}

TEST(WarpedSource, HidesWhatIsNoGroundAndWhatIsNotKnown) {
  TwoDates dates = make_two_dates(kWarpedSide_px, wavy_field, "hidden");
  dates.second.valid(cv::Rect(300, 300, 50, 50)) = 0;
  dates.second.pixels(cv::Rect(300, 300, 50, 50)) = 255;
  const auto known = fitted();
  const Raster drawn =
      warped_source(gray_source_from(dates.second), known).read({0, 0, kWarpedSide_px, kWarpedSide_px});
  const GeoTransform& place = dates.second.map_from_pixel;
  for (int row = 60; row < 640; ++row) {
    for (int col = 60; col < 640; ++col) {
      const Eigen::Vector2d point = place.map_from_pixel({col + 0.5, row + 0.5});
      const Eigen::Vector2d there = place.pixel_from_map(point + wavy_field(point));
      const double outside = std::max(std::abs(there.x() - 325), std::abs(there.y() - 325)) - 25;
      if (outside >= 1 && outside <= 4) continue;
      EXPECT_EQ(drawn.valid.at<std::uint8_t>(row, col), outside < 1 ? 0 : 255) << col << ' ' << row;
    }
  }
  WarpField nothing = *known;
  std::fill(nothing.cell_known.begin(), nothing.cell_known.end(), std::uint8_t{0});
  const auto shared = std::make_shared<const WarpField>(nothing);
  const GraySource source = gray_source_from(dates.second);
  EXPECT_EQ(cv::countNonZero(warped_source(source, shared).read({0, 0, 600, 600}).valid), 0);
  EXPECT_GT(cv::countNonZero(warped_source(source, shared, true).read({0, 0, 600, 600}).valid), 300000);
}

}  // namespace
}  // namespace pilotage
