#include <cmath>
#include <filesystem>
#include <fstream>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/error.h"
#include "pilotage/raster/gdal_gray.h"
#include "pilotage/raster/gdal_imagery.h"

// A folder of a web map's tiles, z/x/y.png, is imagery as it lies there: what was refused with a remedy.

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::TemporaryFolder;

constexpr double kWorld_m = 2 * 20037508.342789244;
constexpr int kZoom = 17;
constexpr int kColumn = 71540;
constexpr int kRow = 41000;

/// A tile whose gray is `gray` in its northern half and 10 more in its southern.
void write_tile(const fs::path& folder, int zoom, int x, int y, int gray, const std::string& ending = ".png",
                int channels = 3, int size_px = 256) {
  cv::Mat tile(size_px, size_px, CV_MAKETYPE(CV_8U, channels), cv::Scalar::all(gray));
  tile.rowRange(size_px / 2, size_px).setTo(cv::Scalar::all(gray + 10));
  if (channels == 4) {
    std::vector<cv::Mat> bands;
    cv::split(tile, bands);
    bands[3].setTo(255);
    bands[3].colRange(0, size_px / 4).setTo(0);
    cv::merge(bands, tile);
  }
  const fs::path file = folder / std::to_string(zoom) / std::to_string(x) / (std::to_string(y) + ending);
  fs::create_directories(file.parent_path());
  ASSERT_TRUE(cv::imwrite(file.string(), tile));
}

std::string tile_folder_error(const fs::path& folder) {
  return testing::error_of<DataError>([&] { inspect_imagery(folder.string()); });
}

TEST(TileFolder, IsOneRasterInItsPlace) {
  const TemporaryFolder folder;
  write_tile(folder.path(), kZoom, kColumn, kRow, 50);
  write_tile(folder.path(), kZoom, kColumn + 1, kRow, 100, ".png", 4);
  write_tile(folder.path(), kZoom, kColumn, kRow + 1, 150, ".png", 1);
  write_tile(folder.path(), kZoom - 1, kColumn / 2, kRow / 2, 200);
  const std::string name = folder.path().string();
  const ImageryInfo info = inspect_imagery(name);
  EXPECT_EQ(info.crs.authority(), "EPSG:3857");
  EXPECT_EQ(info.width_px, 512);
  EXPECT_EQ(info.height_px, 512);
  const double side_m = kWorld_m / std::exp2(kZoom);
  EXPECT_NEAR(info.map_from_pixel.origin_x, kColumn * side_m - kWorld_m / 2, 1e-6);
  EXPECT_NEAR(info.map_from_pixel.origin_y, kWorld_m / 2 - kRow * side_m, 1e-6);
  EXPECT_NEAR(info.map_from_pixel.x_per_col, side_m / 256, 1e-9);
  EXPECT_EQ(info.mask, MaskKind::kAlpha);
  EXPECT_THAT(info.warnings, ElementsAre(HasSubstr("taken for z/x/y with rows from the north")));

  const Raster raster = open_gray(name).read({0, 0, 512, 512});
  const auto gray = [&](int col, int row) { return static_cast<int>(raster.pixels.at<std::uint8_t>(row, col)); };
  const auto valid = [&](int col, int row) { return raster.valid.at<std::uint8_t>(row, col) != 0; };
  EXPECT_EQ(gray(10, 10), 50);
  EXPECT_EQ(gray(10, 200), 60) << "the southern half lies below";
  EXPECT_EQ(gray(400, 10), 100);
  EXPECT_EQ(gray(10, 300), 150) << "a tile of one band";
  EXPECT_TRUE(valid(10, 10));
  EXPECT_FALSE(valid(256 + 10, 10)) << "transparent in its tile";
  EXPECT_TRUE(valid(400, 10));
  EXPECT_TRUE(valid(10, 300)) << "a tile without alpha is opaque";
  EXPECT_FALSE(valid(400, 400)) << "no tile lies there";
}

TEST(TileFolder, RowsFromTheSouthAreKnownByWhatTheFolderSays) {
  const TemporaryFolder folder;
  const int tms_row = (1 << kZoom) - 1 - kRow;
  for (const char* kind : {"gdal2tiles", "tilejson"}) {
    const fs::path tiles = folder / kind;
    write_tile(tiles, kZoom, kColumn, tms_row, 50);
    if (kind == std::string("gdal2tiles")) {
      std::ofstream(tiles / "tilemapresource.xml") << "<TileMap><SRS>EPSG:3857</SRS></TileMap>";
    } else {
      std::ofstream(tiles / "metadata.json") << R"({"scheme": "tms", "name": "x"})";
    }
    const ImageryInfo info = inspect_imagery(tiles.string());
    EXPECT_NEAR(info.map_from_pixel.origin_y, kWorld_m / 2 - kRow * kWorld_m / std::exp2(kZoom), 1e-6) << kind;
    EXPECT_THAT(info.warnings, IsEmpty()) << kind;
  }
}

TEST(TileFolder, RowsBeforeColumnsAreKnownByWhatTheFolderSays) {
  const TemporaryFolder straight;
  write_tile(straight.path(), kZoom, kColumn, kRow, 50);
  write_tile(straight.path(), kZoom, kColumn, kRow + 1, 100);
  const TemporaryFolder turned;  // z/y/x
  write_tile(turned.path(), kZoom, kRow, kColumn, 50);
  write_tile(turned.path(), kZoom, kRow + 1, kColumn, 100);
  const ImageryInfo right = inspect_imagery(straight.path().string());
  // The middle of the right reading is told, by what reads the folder wrongly.
  const ImageryInfo unsaid = inspect_imagery(turned.path().string());
  const std::string middle = "as z/y/x (ArcGIS servers) lon 16.4919, lat ";
  EXPECT_THAT(unsaid.warnings, ElementsAre(HasSubstr(middle)));
  EXPECT_NEAR(right.center.lon_deg, 16.4919, 1e-4);
  std::ofstream(turned / "metadata.json") << R"({"scheme": "zyx"})";
  const TemporaryFolder again;  // a folder is read once in a run
  fs::copy(turned.path(), again.path() / "tiles", fs::copy_options::recursive);
  const ImageryInfo said = inspect_imagery((again.path() / "tiles").string());
  EXPECT_THAT(said.warnings, IsEmpty());
  EXPECT_EQ(said.center.lon_deg, right.center.lon_deg);
  EXPECT_EQ(said.center.lat_deg, right.center.lat_deg);
}

TEST(TileFolder, TilesOfDenseScreensAreTiles) {
  const TemporaryFolder folder;
  write_tile(folder.path(), kZoom, kColumn, kRow, 50, "@2x.png", 3, 512);
  const ImageryInfo info = inspect_imagery(folder.path().string());
  EXPECT_EQ(info.width_px, 512);
  const TemporaryFolder twice;
  write_tile(twice.path(), kZoom, kColumn, kRow, 50);
  write_tile(twice.path(), kZoom, kColumn, kRow, 50, "@2x.png");
  EXPECT_THAT(tile_folder_error(twice.path()), HasSubstr("are the same tile"));
  const TemporaryFolder other;
  write_tile(other.path(), kZoom, kColumn, kRow, 50, "@dark.png");
  EXPECT_THAT(tile_folder_error(other.path()), HasSubstr("holds no tiles"));
}

TEST(TileFolder, PalettesAndJpegAreReadAsColours) {
  const TemporaryFolder folder;
  write_tile(folder / "jpg", kZoom, kColumn, kRow, 90, ".jpg");
  EXPECT_NEAR(open_gray((folder / "jpg").string()).read({0, 0, 8, 8}).pixels.at<std::uint8_t>(4, 4), 90, 2);
  // A PNG with a palette, by GDAL itself: index 7 is the colour (40, 40, 40), index 9 transparent.
  const fs::path file =
      folder / "palette" / std::to_string(kZoom) / std::to_string(kColumn) / (std::to_string(kRow) + ".png");
  fs::create_directories(file.parent_path());
  testing::RasterSpec spec;
  spec.width = spec.height = 256;
  spec.value = [](int, int col, int) { return col < 128 ? 7 : 9; };
  spec.finish = [](GDALDataset& dataset) {
    GDALColorTable colors;
    const GDALColorEntry gray{40, 40, 40, 255};
    const GDALColorEntry clear{0, 0, 0, 0};
    colors.SetColorEntry(7, &gray);
    colors.SetColorEntry(9, &clear);
    dataset.GetRasterBand(1)->SetColorTable(&colors);
    dataset.GetRasterBand(1)->SetNoDataValue(9);  // a TIFF's colours have no alpha; in the PNG they have
  };
  const std::string tif = make_raster(folder / "palette.tif", spec);
  GDALDataset* const source = GDALDataset::Open(tif.c_str());
  GDALDataset* const png =
      GetGDALDriverManager()->GetDriverByName("PNG")->CreateCopy(file.c_str(), source, 0, nullptr, nullptr, nullptr);
  GDALClose(png);
  GDALClose(source);
  const Raster raster = open_gray((folder / "palette").string()).read({0, 0, 256, 256});
  EXPECT_EQ(raster.pixels.at<std::uint8_t>(4, 4), 40);
  EXPECT_NE(raster.valid.at<std::uint8_t>(4, 4), 0);
  EXPECT_EQ(raster.valid.at<std::uint8_t>(4, 200), 0);
}

TEST(TileFolder, RefusesWhatIsNoTilesByName) {
  const TemporaryFolder folder;
  const auto with = [&](const char* name, int x, int y, int size_px) {
    write_tile(folder / name, kZoom, kColumn, kRow, 50);
    write_tile(folder / name, kZoom, x, y, 50, ".png", 3, size_px);
    return tile_folder_error(folder / name);
  };
  EXPECT_THAT(with("sizes", kColumn, kRow + 1, 128), HasSubstr("41001.png: has 128 px"));
  EXPECT_THAT(with("column", 1 << kZoom, 5, 256), HasSubstr("columns and rows of this level are 0 to 131071"));
  fs::create_directories(folder / "empty" / "17");
  EXPECT_THAT(tile_folder_error(folder / "empty"), HasSubstr("holds no tiles z/x/y.png"));
  fs::create_directories(folder / "other");
  EXPECT_THAT(tile_folder_error(folder / "other"), HasSubstr("is a folder, but not of tiles named z/x/y.png"));
  write_tile(folder / "twice", kZoom, kColumn, kRow, 50);
  write_tile(folder / "twice", kZoom, kColumn, kRow, 50, ".jpg");
  EXPECT_THAT(tile_folder_error(folder / "twice"), HasSubstr("are the same tile"));
  write_tile(folder / "geodetic", kZoom, kColumn, kRow, 50);
  std::ofstream(folder / "geodetic" / "tilemapresource.xml") << "<TileMap><SRS>EPSG:4326</SRS></TileMap>";
  EXPECT_THAT(tile_folder_error(folder / "geodetic"), HasSubstr("not of the web's Mercator"));
}

// What may not be opened otherwise may not be opened as a tile either: another file by a link, a VRT by a tile's name.
TEST(TileFolder, LeadsToNoOtherFile) {
  const TemporaryFolder folder;
  write_tile(folder / "elsewhere", kZoom, kColumn, kRow, 50);
  const fs::path column = folder / "links" / std::to_string(kZoom) / std::to_string(kColumn);
  fs::create_directories(column);
  const fs::path tile =
      folder / "elsewhere" / std::to_string(kZoom) / std::to_string(kColumn) / (std::to_string(kRow) + ".png");
  fs::create_symlink(tile, column / "5.png");
  EXPECT_THAT(tile_folder_error(folder / "links"), HasSubstr("5.png: is a symbolic link"));
  const fs::path vrt = folder / "vrt" / std::to_string(kZoom) / std::to_string(kColumn);
  fs::create_directories(vrt);
  std::ofstream(vrt / "5.png")
      << "<VRTDataset rasterXSize=\"256\" rasterYSize=\"256\"><VRTRasterBand dataType=\"Byte\" "
         "band=\"1\"><SimpleSource><SourceFilename>"
      << tile.string() << "</SourceFilename></SimpleSource></VRTRasterBand></VRTDataset>";
  EXPECT_THAT(tile_folder_error(folder / "vrt"), HasSubstr("5.png: is not a PNG, JPEG or WebP picture"));
}

TEST(TileFolder, SaysWhereAShallowerLevelCoversMore) {
  const TemporaryFolder folder;
  write_tile(folder.path(), kZoom, kColumn, kRow, 50);
  for (int x = 0; x < 3; ++x) write_tile(folder.path(), kZoom - 1, kColumn / 2 + x, kRow / 2, 50);
  EXPECT_THAT(inspect_imagery(folder.path().string()).warnings,
              ::testing::Contains(HasSubstr("its level 17 is read, which has 1 tiles; level 16 has 3")));
}

}  // namespace
}  // namespace pilotage
