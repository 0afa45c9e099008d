#include "pilotage/score/usual_contrast.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

/// Squares of 5 px, their gray values drawn evenly from 100 − reach to 100 + reach: σ/f̄ = reach / 100 / √3.
void draw_squares(const cv::Mat& pixels, int reach, Random& random) {
  for (int row = 0; row < pixels.rows; row += 5) {
    for (int col = 0; col < pixels.cols; col += 5) {
      const cv::Rect square = cv::Rect(col, row, 5, 5) & cv::Rect(0, 0, pixels.cols, pixels.rows);
      pixels(square).setTo(std::lround(100 + reach * (2 * random.uniform() - 1)));
    }
  }
}

double contrast_of(int reach) {
  return reach / 100.0 / std::sqrt(3.0);
}

Raster squares(int reach) {
  Random random(seed_from_name("usual contrast"));
  Raster raster;
  raster.pixels = cv::Mat(600, 600, CV_8U);
  raster.valid = cv::Mat(600, 600, CV_8U, cv::Scalar(255));
  draw_squares(raster.pixels, reach, random);
  return raster;
}

TEST(UsualContrast, IsThatOfTheGround) {
  EXPECT_NEAR(usual_contrast(gray_source_from(squares(20)), 60), contrast_of(20), 0.005);
  EXPECT_NEAR(usual_contrast(gray_source_from(squares(80)), 60), contrast_of(80), 0.02);
}

TEST(UsualContrast, IsTheMedianOverTheImagery) {
  Raster raster = squares(20);
  Random random(seed_from_name("a third of another kind"));
  draw_squares(raster.pixels(cv::Rect(400, 0, 200, 600)), 80, random);
  EXPECT_NEAR(usual_contrast(gray_source_from(raster), 100), contrast_of(20), 0.015);
}

TEST(UsualContrast, WaterAndWhatIsNotThereDoNotCount) {
  const double usual = usual_contrast(gray_source_from(squares(20)), 60);
  Raster raster = squares(20);
  raster.pixels(cv::Rect(0, 0, 420, 600)).setTo(40);
  EXPECT_NEAR(usual_contrast(gray_source_from(raster), 60), usual, 0.02) << "a lake over most of it";
  raster.valid(cv::Rect(0, 0, 420, 600)).setTo(0);
  const double without = usual_contrast(gray_source_from(raster), 60);
  EXPECT_NEAR(without, usual, 0.005);
  raster.pixels(cv::Rect(0, 0, 420, 600)).setTo(255);
  EXPECT_EQ(usual_contrast(gray_source_from(raster), 60), without) << "what stands where there is no ground";
}

TEST(UsualContrast, IsNotDefinedWhereNothingCanBeRecognised) {
  Raster raster = squares(20);
  raster.pixels.setTo(128);
  EXPECT_TRUE(std::isnan(usual_contrast(gray_source_from(raster), 60)));
}

TEST(UsualContrast, TakesTilesLargerThanTheImagery) {
  EXPECT_NEAR(usual_contrast(gray_source_from(squares(20)), 4000), contrast_of(20), 0.005);
}

TEST(UsualContrast, WantsEightBitsAndASide) {
  Raster raster = squares(20);
  EXPECT_THROW(usual_contrast(gray_source_from(raster), 0), UsageError);
  raster.pixels.convertTo(raster.pixels, CV_16U);
  EXPECT_THROW(usual_contrast(gray_source_from(raster), 60), UsageError);
}

}  // namespace
}  // namespace pilotage
