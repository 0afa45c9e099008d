#include "pilotage/report/tile_pictures.h"

#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

// Six tiles of 40 px side by side on a raster's own grid, two columns by three rows, 20 px apart.
Ground ground_over(const std::string& dataset, const testing::RasterSpec& spec) {
  Ground ground;
  ground.crs = Crs::from_user_input("EPSG:32633");
  ground.imagery.datasets.push_back({dataset, 0.5, "EPSG:32633", "", spec.width, spec.height});
  GridLevel level;
  level.gsd_m = 0.5;
  level.matrix = {0, spec.place, spec.width, spec.height, 40, 20};
  for (std::int64_t row = 0; row < level.matrix.matrix_height(); ++row) {
    for (std::int64_t column = 0; column < level.matrix.matrix_width(); ++column) {
      GroundTile tile;
      tile.tile_id = static_cast<std::int64_t>(ground.tiles.size());
      tile.column = column;
      tile.row = row;
      ground.tiles.push_back(tile);
    }
  }
  ground.levels.push_back(level);
  return ground;
}

testing::RasterSpec blocks(int bands, GDALDataType type, double factor) {
  testing::RasterSpec spec;
  spec.width = 60;
  spec.height = 80;
  spec.bands = bands;
  spec.type = type;
  // Blocks of 20 px: a tile's quarters have one value each.
  spec.value = [factor](int band, int col, int row) { return factor * (10 * (row / 20 * 3 + col / 20) + 60 * band); };
  return spec;
}

TEST(TilePictures, EachIsItsTileInColour) {
  const testing::TemporaryFolder folder;
  const testing::RasterSpec spec = blocks(3, GDT_Byte, 1);
  const Ground ground = ground_over(testing::make_raster(folder / "a.tif", spec), spec);
  ASSERT_EQ(ground.tiles.size(), 6U);
  const TilePictures pictures = read_tile_pictures(ground, 1);
  ASSERT_EQ(pictures.side_px, 96);
  ASSERT_EQ(pictures.sheet.type(), CV_8UC3);
  for (std::size_t i = 0; i < ground.tiles.size(); ++i) {
    const cv::Mat picture = pictures.sheet(pictures.place(i));
    for (int quarter = 0; quarter < 4; ++quarter) {
      const int row = static_cast<int>(ground.tiles[i].row) + quarter / 2;
      const int column = static_cast<int>(ground.tiles[i].column) + quarter % 2;
      const int red = 10 * (row * 3 + column);
      EXPECT_EQ(picture.at<cv::Vec3b>(24 + 48 * (quarter / 2), 24 + 48 * (quarter % 2)),
                cv::Vec3b(red, red + 60, red + 120))
          << "tile " << i << ", quarter " << quarter;
    }
  }
  const TilePictures again = read_tile_pictures(ground, 4);
  EXPECT_EQ(cv::norm(pictures.sheet, again.sheet, cv::NORM_INF), 0) << "differs between 1 and 4 threads";
}

TEST(TilePictures, DeepGrayIsStretchedOverAllAndWhatIsMissingIsGray) {
  const testing::TemporaryFolder folder;
  testing::RasterSpec spec = blocks(1, GDT_UInt16, 500);
  spec.finish = [](GDALDataset& dataset) { dataset.GetRasterBand(1)->SetNoDataValue(0); };  // the first block
  const Ground ground = ground_over(testing::make_raster(folder / "a.tif", spec), spec);
  const TilePictures pictures = read_tile_pictures(ground);
  const auto at = [&](std::size_t i, int x, int y) { return pictures.sheet(pictures.place(i)).at<cv::Vec3b>(y, x); };
  EXPECT_EQ(at(0, 24, 24), cv::Vec3b::all(192)) << "no imagery";
  EXPECT_EQ(at(0, 72, 24), cv::Vec3b::all(0)) << "the lowest value";
  EXPECT_EQ(at(5, 72, 72), cv::Vec3b::all(255)) << "the highest";
  EXPECT_EQ(at(0, 72, 72), at(3, 24, 24)) << "one stretch for all tiles";
  EXPECT_LT(at(0, 24, 72)[0], at(0, 72, 72)[0]);
}

TEST(TilePictures, StopWhenAskedTo) {
  const testing::TemporaryFolder folder;
  const testing::RasterSpec spec = blocks(1, GDT_Byte, 1);
  const Ground ground = ground_over(testing::make_raster(folder / "a.tif", spec), spec);
  EXPECT_THROW(read_tile_pictures(ground, 2, [](std::string_view, std::int64_t, std::int64_t) { return false; }),
               Interrupted);
  EXPECT_TRUE(read_tile_pictures(Ground{}).sheet.empty());
}

TEST(TilePictures, SidesKeepTheSheetSmall) {
  EXPECT_EQ(tile_picture_side_px(1), 96);
  EXPECT_EQ(tile_picture_side_px(651), 96);
  EXPECT_EQ(tile_picture_side_px(652), 64);
  EXPECT_EQ(tile_picture_side_px(1465), 48);
  EXPECT_EQ(tile_picture_side_px(5000), 32);
  EXPECT_EQ(tile_picture_side_px(15625), 32);
  EXPECT_EQ(tile_picture_side_px(15626), 0);
}

}  // namespace
}  // namespace pilotage
