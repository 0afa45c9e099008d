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

/// A ground of three levels and the scores of some tiles of it.
struct Scored {
  Ground ground;
  std::vector<TileScores> scores;

  ScoreTable table() const { return {ground, scores}; }
};

struct SomeTile {
  int level;
  std::int64_t column;
  std::int64_t row;
  double variance;
};

Scored scored(const std::vector<SomeTile>& tiles) {
  Scored made;
  for (int level = 0; level < 3; ++level) {
    made.ground.levels.emplace_back();
    made.ground.levels.back().matrix = make_matrix(level);
  }
  for (const SomeTile& some : tiles) {
    GroundTile tile;
    tile.level = some.level;
    tile.column = some.column;
    tile.row = some.row;
    tile.tile_id = tile_id_of(made.ground.levels, some.level, some.column, some.row);
    made.ground.tiles.push_back(tile);
    TileScores score;
    score.valid_fraction = 0.5;
    score.gray_variance = some.variance;
    made.scores.push_back(score);
  }
  return made;
}

// The centre of a raster pixel is the centre of its tile, for a turned grid too; the raster is cropped to the tiles.
TEST(ScoreRaster, PixelsLieAroundTheCentresOfTheTiles) {
  const TileMatrix matrix = make_matrix(0);
  const Scored two = scored({{0, 3, 2, 7}, {0, 5, 4, 8}});
  const ScoreRaster raster = score_raster(two.table(), 0);
  ASSERT_FALSE(raster.bands.empty());
  EXPECT_EQ(raster.bands[0].name, "valid_fraction");
  for (const ScoreBand& band : raster.bands) {
    EXPECT_EQ(band.values.size(), cv::Size(3, 3));
  }
  for (const GroundTile& tile : two.ground.tiles) {
    const PixelWindow window = matrix.tile_window(tile.cell());
    const Eigen::Vector2d tile_center = matrix.map_from_pixel.map_from_pixel(
        {static_cast<double>(window.col) + 30, static_cast<double>(window.row) + 30});
    const Eigen::Vector2d pixel_center = raster.map_from_pixel.map_from_pixel(
        {static_cast<double>(tile.column - 3) + 0.5, static_cast<double>(tile.row - 2) + 0.5});
    EXPECT_NEAR((tile_center - pixel_center).norm(), 0, 1e-9);
  }
}

TEST(ScoreRaster, HoldsTheLevelsTilesAndTheMeasuresThatHaveValues) {
  const Scored some = scored({{0, 1, 1, 5}, {1, 2, 1, 7}, {1, 3, 1, 8}, {1, 2, 2, std::nan("")}});
  const ScoreRaster raster = score_raster(some.table(), 1);
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

TEST(ScoreRaster, NoTilesNoBandsAndTilesOutsideAreRefused) {
  const Scored one = scored({{0, 1, 1, 5}});
  EXPECT_TRUE(score_raster(one.table(), 2).bands.empty());
  for (const auto& [column, row] : {std::pair{-1, 0}, {0, -1}, {18, 0}, {0, 13}}) {
    const Scored outside = scored({{0, column, row, 5}});
    EXPECT_THROW(score_raster(outside.table(), 0), DataError) << column << ", " << row;
  }
  const Scored last = scored({{0, 17, 12, 5}});
  EXPECT_NO_THROW(score_raster(last.table(), 0));
}

TEST(ClassRaster, LiesOnThePixelsOfTheScoreRaster) {
  const Scored some = scored({{0, 3, 2, 7}, {0, 5, 4, 8}, {1, 0, 0, 9}});
  const cv::Mat classes = class_raster(
      some.table(), 0, [](const TileScores& score) { return static_cast<std::uint8_t>(score.gray_variance); });
  EXPECT_EQ(classes.size(), score_raster(some.table(), 0).bands[0].values.size());
  EXPECT_EQ(classes.type(), CV_8U);
  EXPECT_EQ(classes.at<std::uint8_t>(0, 0), 7);
  EXPECT_EQ(classes.at<std::uint8_t>(2, 2), 8);
  EXPECT_EQ(classes.at<std::uint8_t>(1, 1), kNoClass);
  EXPECT_TRUE(class_raster(some.table(), 2, [](const TileScores&) { return std::uint8_t{0}; }).empty());
}

}  // namespace
}  // namespace pilotage
