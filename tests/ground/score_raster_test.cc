#include "pilotage/ground/score_raster.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

TileMatrix make_matrix(int level) {
  TileMatrix matrix;
  matrix.level = level;
  matrix.map_from_pixel = GeoTransform{500, 3, 4, 900, 4, -3};  // pixels of 5 m, turned by 53°
  matrix.grid_width_px = 400;
  matrix.grid_height_px = 300;
  matrix.tile_size_px = 60;
  matrix.stride_px = 20;
  return matrix;
}

TileRow make_row(int level, std::int64_t column, std::int64_t row, double variance) {
  TileRow made;
  made.tile.level = level;
  made.tile.column = column;
  made.tile.row = row;
  made.score.valid_fraction = 0.5;
  made.score.gray_variance = variance;
  return made;
}

// The centre of a raster pixel is the centre of its tile, for a turned grid too; the raster is cropped to the tiles.
TEST(ScoreRaster, PixelsLieAroundTheCentresOfTheTiles) {
  const TileMatrix matrix = make_matrix(0);
  const std::vector<TileRow> rows{make_row(0, 3, 2, 7), make_row(0, 5, 4, 8)};
  const ScoreRaster raster = score_raster(matrix, rows);
  ASSERT_FALSE(raster.bands.empty());
  EXPECT_EQ(raster.bands[0].name, "valid_fraction");
  for (const ScoreBand& band : raster.bands) {
    EXPECT_EQ(band.values.size(), cv::Size(3, 3));
  }
  for (const TileRow& row : rows) {
    const PixelWindow window = matrix.tile_window(row.tile.column, row.tile.row);
    const Eigen::Vector2d tile_center = matrix.map_from_pixel.map_from_pixel(
        {static_cast<double>(window.col) + 30, static_cast<double>(window.row) + 30});
    const Eigen::Vector2d pixel_center = raster.map_from_pixel.map_from_pixel(
        {static_cast<double>(row.tile.column - 3) + 0.5, static_cast<double>(row.tile.row - 2) + 0.5});
    EXPECT_NEAR((tile_center - pixel_center).norm(), 0, 1e-9);
  }
}

TEST(ScoreRaster, HoldsTheLevelsRowsAndTheColumnsThatAreMeasured) {
  const std::vector<TileRow> rows{make_row(0, 1, 1, 5), make_row(1, 2, 1, 7), make_row(1, 3, 1, 8),
                                  make_row(1, 2, 2, std::nan(""))};
  const ScoreRaster raster = score_raster(make_matrix(1), rows);
  ASSERT_EQ(raster.bands.size(), 2u);
  EXPECT_EQ(raster.bands[1].name, "gray_variance");
  EXPECT_EQ(raster.bands[1].unit, "gray levels");
  const cv::Mat& values = raster.bands[1].values;
  ASSERT_EQ(values.size(), cv::Size(2, 2));
  EXPECT_EQ(values.at<double>(0, 0), 7);
  EXPECT_EQ(values.at<double>(0, 1), 8);
  EXPECT_TRUE(std::isnan(values.at<double>(1, 0)));
  EXPECT_TRUE(std::isnan(values.at<double>(1, 1)));
  EXPECT_EQ(raster.bands[0].values.at<double>(1, 0), 0.5);
  EXPECT_TRUE(std::isnan(raster.bands[0].values.at<double>(1, 1)));
}

TEST(ScoreRaster, NoRowsNoBandsAndRowsOutsideAreRefused) {
  EXPECT_TRUE(score_raster(make_matrix(2), std::vector<TileRow>{make_row(0, 1, 1, 5)}).bands.empty());
  for (const auto& [column, row] : {std::pair{-1, 0}, {0, -1}, {18, 0}, {0, 13}}) {
    EXPECT_THROW(score_raster(make_matrix(0), std::vector<TileRow>{make_row(0, column, row, 5)}), DataError)
        << column << ", " << row;
  }
  EXPECT_NO_THROW(score_raster(make_matrix(0), std::vector<TileRow>{make_row(0, 17, 12, 5)}));
}

TEST(ClassRaster, LiesOnThePixelsOfTheScoreRaster) {
  const std::vector<TileRow> rows{make_row(0, 3, 2, 7), make_row(0, 5, 4, 8), make_row(1, 0, 0, 9)};
  const TileMatrix matrix = make_matrix(0);
  const cv::Mat classes =
      class_raster(matrix, rows, [](const TileRow& row) { return static_cast<std::uint8_t>(row.score.gray_variance); });
  EXPECT_EQ(classes.size(), score_raster(matrix, rows).bands[0].values.size());
  EXPECT_EQ(classes.type(), CV_8U);
  EXPECT_EQ(classes.at<std::uint8_t>(0, 0), 7);
  EXPECT_EQ(classes.at<std::uint8_t>(2, 2), 8);
  EXPECT_EQ(classes.at<std::uint8_t>(1, 1), kNoClass);
  EXPECT_TRUE(class_raster(make_matrix(2), rows, [](const TileRow&) { return std::uint8_t{0}; }).empty());
}

}  // namespace
}  // namespace pilotage
