#include "pilotage/matchability/fine_contrast.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "testing/matrix_over.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

/// Squares of 5 px, their gray values drawn evenly from 100 − reach to 100 + reach.
void draw_squares(const cv::Mat& pixels, int reach, Random& random) {
  for (int row = 0; row < pixels.rows; row += 5) {
    for (int col = 0; col < pixels.cols; col += 5) {
      const cv::Rect square = cv::Rect(col, row, 5, 5) & cv::Rect(0, 0, pixels.cols, pixels.rows);
      pixels(square).setTo(std::lround(100 + reach * (2 * random.uniform() - 1)));
    }
  }
}

Raster squares(int reach, int side_px = 600) {
  Random random(seed_from_name("fine contrast"));
  Raster raster;
  raster.pixels = cv::Mat(side_px, side_px, CV_8U);
  raster.valid = cv::Mat(side_px, side_px, CV_8U, cv::Scalar(255));
  draw_squares(raster.pixels, reach, random);
  return raster;
}

/// The mean over the ground around a pixel, as it is defined.
double mean_around(const Raster& raster, int row, int col, int reach_px) {
  double sum = 0;
  int count = 0;
  for (int r = std::max(row - reach_px, 0); r <= std::min(row + reach_px, raster.pixels.rows - 1); ++r) {
    for (int c = std::max(col - reach_px, 0); c <= std::min(col + reach_px, raster.pixels.cols - 1); ++c) {
      if (raster.valid.at<std::uint8_t>(r, c) == 0) continue;
      sum += raster.pixels.at<std::uint8_t>(r, c);
      ++count;
    }
  }
  return sum / count;
}

double contrast_by_definition(const Raster& raster, const PixelWindow& tile) {
  double sum = 0;
  int count = 0;
  for (auto row = static_cast<int>(tile.row); row < tile.row + tile.height; ++row) {
    for (auto col = static_cast<int>(tile.col); col < tile.col + tile.width; ++col) {
      if (raster.valid.at<std::uint8_t>(row, col) == 0) continue;
      sum += std::abs(mean_around(raster, row, col, 1) - mean_around(raster, row, col, 7));
      ++count;
    }
  }
  return count == 0 ? std::nan("") : sum / count;
}

TEST(FineContrast, IsWhatItsDefinitionSays) {
  Raster raster = squares(60, 150);
  raster.valid(cv::Rect(0, 40, 70, 60)).setTo(0);
  raster.pixels(cv::Rect(0, 40, 70, 60)).setTo(255);  // what stands where there is no ground
  const GraySource source = gray_source_from(raster);
  const TileMatrix matrix = testing::matrix_over(source, 50, 25);
  const std::vector<std::int64_t> indices = testing::all_tiles(matrix);
  const auto contrasts = measure_fine_contrast(source, matrix, indices, 1);
  ASSERT_EQ(contrasts.size(), indices.size());
  int without_ground = 0;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const double expected = contrast_by_definition(raster, matrix.tile_window(matrix.cell_of(indices[i])));
    if (std::isnan(expected)) {
      ++without_ground;
      EXPECT_TRUE(std::isnan(contrasts[i])) << "tile " << indices[i];
    } else {
      EXPECT_NEAR(contrasts[i], expected, 1.0 / 512) << "tile " << indices[i];
    }
  }
  EXPECT_EQ(without_ground, 1);
}

TEST(FineContrast, DependsNeitherOnThreadsNorOnTheOtherTiles) {
  const GraySource source = gray_source_from(squares(60, 3000));  // several groups
  const TileMatrix matrix = testing::matrix_over(source, 100, 70);
  const std::vector<std::int64_t> indices = testing::all_tiles(matrix);
  const auto contrasts = measure_fine_contrast(source, matrix, indices, 1);
  EXPECT_EQ(measure_fine_contrast(source, matrix, indices, 3), contrasts);
  for (const std::int64_t index : {std::int64_t{0}, std::int64_t{700}, indices.back()}) {
    EXPECT_EQ(measure_fine_contrast(source, matrix, {&index, 1}, 1),
              std::vector<double>{contrasts[static_cast<std::size_t>(index)]});
  }
}

TEST(FineContrast, DoesNotSeeHowDarkAWoodIsBesideAField) {
  Raster raster = squares(20, 200);
  raster.pixels(cv::Rect(100, 0, 100, 200)) -= 60;
  const TileMatrix matrix = testing::matrix_over(gray_source_from(raster), 200, 200);
  const std::int64_t only = 0;
  const double with_wood = measure_fine_contrast(gray_source_from(raster), matrix, {&only, 1}, 1)[0];
  const double without = measure_fine_contrast(gray_source_from(squares(20, 200)), matrix, {&only, 1}, 1)[0];
  EXPECT_NEAR(with_wood / without, 1, 0.12) << "its edge alone";
}

TEST(UsualFineContrast, IsThatOfTheGround) {
  const double of_20 = usual_fine_contrast(gray_source_from(squares(20)), 60);
  const double of_80 = usual_fine_contrast(gray_source_from(squares(80)), 60);
  EXPECT_NEAR(of_80 / of_20, 4, 0.1);
  const Raster raster = squares(20);
  EXPECT_NEAR(of_20, contrast_by_definition(raster, {0, 0, 600, 600}), 0.2);
  EXPECT_EQ(usual_fine_contrast(gray_source_from(raster), 60, 1), of_20) << "one thread";
}

TEST(UsualFineContrast, IsTheMedianOverTheImagery) {
  Raster raster = squares(20);
  const double usual = usual_fine_contrast(gray_source_from(raster), 100);
  Random random(seed_from_name("a third of another kind"));
  draw_squares(raster.pixels(cv::Rect(400, 0, 200, 600)), 80, random);
  EXPECT_NEAR(usual_fine_contrast(gray_source_from(raster), 100) / usual, 1, 0.05);
}

TEST(UsualFineContrast, WaterAndWhatIsNotThereDoNotCount) {
  const double usual = usual_fine_contrast(gray_source_from(squares(20)), 60);
  Raster raster = squares(20);
  raster.pixels(cv::Rect(0, 0, 420, 600)).setTo(40);
  EXPECT_NEAR(usual_fine_contrast(gray_source_from(raster), 60) / usual, 1, 0.1) << "a lake over most of it";
  raster.valid(cv::Rect(0, 0, 420, 600)).setTo(0);
  const double without = usual_fine_contrast(gray_source_from(raster), 60);
  EXPECT_NEAR(without / usual, 1, 0.05);
  raster.pixels(cv::Rect(0, 0, 420, 600)).setTo(255);
  EXPECT_EQ(usual_fine_contrast(gray_source_from(raster), 60), without) << "what stands where there is no ground";
}

TEST(UsualFineContrast, IsNotDefinedWhereNothingCanBeRecognised) {
  Raster raster = squares(20);
  raster.pixels.setTo(128);
  EXPECT_TRUE(std::isnan(usual_fine_contrast(gray_source_from(raster), 60)));
}

TEST(UsualFineContrast, TakesTilesLargerThanTheImagery) {
  const double usual = usual_fine_contrast(gray_source_from(squares(20)), 60);
  EXPECT_NEAR(usual_fine_contrast(gray_source_from(squares(20)), 4000) / usual, 1, 0.05);
}

TEST(FineContrast, WantsEightBitsAndASide) {
  Raster raster = squares(20);
  EXPECT_THROW(usual_fine_contrast(gray_source_from(raster), 0), UsageError);
  raster.pixels.convertTo(raster.pixels, CV_16U);
  EXPECT_THROW(usual_fine_contrast(gray_source_from(raster), 60), UsageError);
  const std::int64_t only = 0;
  EXPECT_THROW(measure_fine_contrast(gray_source_from(raster), testing::matrix_over(gray_source_from(raster), 60, 60),
                                     {&only, 1}),
               UsageError);
  EXPECT_THROW(measure_fine_contrast(gray_source_from(squares(20)),
                                     testing::matrix_over(gray_source_from(squares(20, 500)), 60, 60), {&only, 1}),
               DataError);
}

}  // namespace
}  // namespace pilotage
