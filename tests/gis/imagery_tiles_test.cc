#include "pilotage/gis/imagery_tiles.h"

#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <set>

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gdal_priv.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/gis/pmtiles.h"
#include "pilotage/mapdb/sqlite.h"
#include "pilotage/raster/gdal_io.h"

namespace pilotage {
namespace {

using testing::make_raster;
using testing::RasterSpec;
using testing::TemporaryFolder;
using Dataset = std::unique_ptr<GDALDataset>;

constexpr int kSide_px = 640;
constexpr double kGsd_m = 0.5;

/// Values that say where they are: red grows to the east, green to the south.
RasterSpec slopes(const std::string& srs = "EPSG:32633") {
  RasterSpec spec;
  spec.width = kSide_px;
  spec.height = kSide_px;
  spec.bands = 3;
  spec.srs = srs;
  spec.value = [](int band, int col, int row) {
    return band == 0 ? 30 + col * 200 / kSide_px : band == 1 ? 30 + row * 200 / kSide_px : 128;
  };
  return spec;
}

/// A ground of tiles of 128 px, side by side, over the raster.
Ground ground_over(const RasterSpec& spec, const std::string& dataset) {
  Ground ground;
  ground.crs = Crs::from_user_input(spec.srs);
  GridLevel level;
  level.gsd_m = kGsd_m;
  level.matrix = {0, spec.place, spec.width, spec.height, 128, 128};
  ground.levels.push_back(level);
  const CrsTransform transform(ground.crs);
  for (std::int64_t row = 0; row < level.matrix.matrix_height(); ++row) {
    for (std::int64_t column = 0; column < level.matrix.matrix_width(); ++column) {
      GroundTile tile;
      tile.tile_id = level.matrix.index_of(column, row);
      tile.column = column;
      tile.row = row;
      tile.bounds = level.matrix.tile_bounds({column, row});
      tile.center = transform.geodetic_from_map(tile.bounds.center_m()).value();
      ground.tiles.push_back(tile);
    }
  }
  ground.imagery.datasets.push_back({dataset, kGsd_m, "", "", spec.width, spec.height});
  return ground;
}

Dataset open_tiles(const std::filesystem::path& path) {
  GDALAllRegister();
  return Dataset(GDALDataset::Open(path.c_str(), GDAL_OF_READONLY | GDAL_OF_RASTER));
}

/// Longitude and latitude → pixel of a raster in EPSG:3857.
Eigen::Vector2d web_pixel(GDALDataset& dataset, const GeodeticPoint& point) {
  std::array<double, 6> t{};
  EXPECT_EQ(dataset.GetGeoTransform(t.data()), CE_None);
  const auto on_web = CrsTransform(Crs::from_user_input("EPSG:3857")).map_from_geodetic(point).value();
  return {(on_web.x() - t[0]) / t[1], (on_web.y() - t[3]) / t[5]};
}

int value_at(GDALDataset& dataset, int band, const Eigen::Vector2d& pixel) {
  std::uint8_t value = 0;
  EXPECT_EQ(dataset.GetRasterBand(band)->RasterIO(GF_Read, static_cast<int>(pixel.x()), static_cast<int>(pixel.y()), 1,
                                                  1, &value, 1, 1, GDT_Byte, 0, 0),
            CE_None);
  return value;
}

TEST(ImageryTiles, GoFromTheImagerysOwnPixelsToAFewTilesThatShowAll) {
  const Ground ground = ground_over(slopes(), "none.tif");
  const std::vector<WebTile> tiles = imagery_tiles_of(ground);
  ASSERT_FALSE(tiles.empty());
  // At 45.15° north half a metre lies between the pixels of zoom 17 (0.84 m) and 18 (0.42 m), nearer to the second.
  EXPECT_EQ(tiles.back().zoom, 18);
  std::map<int, int> counts;
  for (const WebTile& tile : tiles) ++counts[tile.zoom];
  EXPECT_LE(counts.begin()->second, 4);
  EXPECT_GT(std::next(counts.begin())->second, 4) << "one level coarser than needed";
  EXPECT_TRUE(std::is_sorted(tiles.begin(), tiles.end()));
  // 320 m are 3 or 4 tiles of 107 m.
  EXPECT_GE(counts[18], 9);
  EXPECT_LE(counts[18], 16);
}

TEST(ImageryTiles, AreCoarserWhereTheyWouldBeTooMany) {
  const Ground ground = ground_over(slopes(), "none.tif");
  const std::vector<WebTile> tiles = imagery_tiles_of(ground, 8);
  ASSERT_FALSE(tiles.empty());
  EXPECT_EQ(tiles.back().zoom, 17);
}

TEST(ImageryTiles, NoneOverTheAntimeridianAndBeyondTheWebsMap) {
  Ground ground = ground_over(slopes("+proj=aeqd +lat_0=10 +lon_0=180 +datum=WGS84"), "none.tif");
  for (GridLevel& level : ground.levels) level.matrix.map_from_pixel = GeoTransform::north_up(-160, 160, kGsd_m);
  EXPECT_TRUE(imagery_tiles_of(ground).empty());
  RasterSpec polar = slopes("EPSG:3995");
  polar.place = GeoTransform::north_up(1000, 1000, kGsd_m);
  EXPECT_TRUE(imagery_tiles_of(ground_over(polar, "none.tif")).empty());
}

TEST(ImageryTiles, ShowEveryPlaceInItsColours) {
  const TemporaryFolder folder;
  const RasterSpec spec = slopes();
  const Ground ground = ground_over(spec, make_raster(folder / "ortho.tif", spec));
  write_imagery_mbtiles(folder / "a.mbtiles", ground.imagery, imagery_tiles_of(ground),
                        {"harbour", "imagery", "© somebody"}, false, 1);
  const Dataset dataset = open_tiles(folder / "a.mbtiles");
  ASSERT_NE(dataset, nullptr);
  const CrsTransform transform(ground.crs);
  for (const auto& [col, row] : {std::pair{20, 30}, std::pair{600, 40}, std::pair{320, 320}, std::pair{90, 610}}) {
    const auto point = transform.geodetic_from_map(spec.place.map_from_pixel(Eigen::Vector2d(col + 0.5, row + 0.5)));
    const Eigen::Vector2d pixel = web_pixel(*dataset, point.value());
    EXPECT_NEAR(value_at(*dataset, 1, pixel), spec.value(0, col, row), 4) << col;
    EXPECT_NEAR(value_at(*dataset, 2, pixel), spec.value(1, col, row), 4) << row;
    EXPECT_NEAR(value_at(*dataset, 3, pixel), 128, 4);
  }
  EXPECT_STREQ(dataset->GetMetadataItem("name"), "harbour");
  EXPECT_STREQ(dataset->GetMetadataItem("attribution"), "© somebody");
  EXPECT_STREQ(dataset->GetMetadataItem("format"), "jpg");
}

TEST(ImageryTiles, SameBytesForAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const RasterSpec spec = slopes();
  const Ground ground = ground_over(spec, make_raster(folder / "ortho.tif", spec));
  for (const auto& [name, threads] : {std::pair{"one", 1}, std::pair{"four", 4}}) {
    write_imagery_mbtiles(folder / (std::string(name) + ".mbtiles"), ground.imagery, imagery_tiles_of(ground),
                          {"harbour", "", ""}, false, threads);
    write_pmtiles(folder / (std::string(name) + ".pmtiles"), folder / (std::string(name) + ".mbtiles"), false);
  }
  EXPECT_TRUE(read_file(folder / "one.mbtiles") == read_file(folder / "four.mbtiles"));
  EXPECT_TRUE(read_file(folder / "one.pmtiles") == read_file(folder / "four.pmtiles"));
}

TEST(ImageryTiles, GrayOfSixteenBitsIsStretchedAlikeOnAllLevels) {
  const TemporaryFolder folder;
  RasterSpec spec = slopes();
  spec.bands = 1;
  spec.type = GDT_UInt16;
  spec.value = [](int, int col, int) { return 1000 + col * 10; };
  const Ground ground = ground_over(spec, make_raster(folder / "ortho.tif", spec));
  write_imagery_mbtiles(folder / "a.mbtiles", ground.imagery, imagery_tiles_of(ground), {"harbour", "", ""}, false, 1);
  const Dataset dataset = open_tiles(folder / "a.mbtiles");
  ASSERT_NE(dataset, nullptr);
  const CrsTransform transform(ground.crs);
  const auto gray = [&](GDALDataset& level, int col) {
    const auto point = transform.geodetic_from_map(spec.place.map_from_pixel(Eigen::Vector2d(col + 0.5, 320.5)));
    return value_at(level, 1, web_pixel(level, point.value()));
  };
  EXPECT_LT(gray(*dataset, 16), 8);
  EXPECT_GT(gray(*dataset, 620), 245);
  EXPECT_NEAR(gray(*dataset, 320), 127, 8);
}

TEST(ImageryTiles, WithoutAnyImageryThereIsNoFile) {
  const TemporaryFolder folder;
  RasterSpec spec = slopes();
  Ground ground = ground_over(spec, make_raster(folder / "ortho.tif", spec));
  const std::vector<WebTile> all = imagery_tiles_of(ground);
  // The same imagery, ten raster widths away.
  RasterSpec far = spec;
  far.place = GeoTransform::north_up(500000 + 10 * kSide_px * kGsd_m, 5'000'000, kGsd_m);
  ground.imagery.datasets.front().dataset = make_raster(folder / "far.tif", far);
  EXPECT_FALSE(write_imagery_mbtiles(folder / "a.mbtiles", ground.imagery, all, {"harbour", "", ""}, false, 1));
  EXPECT_FALSE(std::filesystem::exists(folder / "a.mbtiles"));
}

TEST(ImageryTiles, StopsWhenAsked) {
  const TemporaryFolder folder;
  const RasterSpec spec = slopes();
  const Ground ground = ground_over(spec, make_raster(folder / "ortho.tif", spec));
  const auto stop = [](std::string_view, std::int64_t done, std::int64_t) { return done == 0; };
  EXPECT_THROW(write_imagery_mbtiles(folder / "a.mbtiles", ground.imagery, imagery_tiles_of(ground),
                                     {"harbour", "", ""}, false, 1, Progress(stop)),
               Interrupted);
  EXPECT_FALSE(std::filesystem::exists(folder / "a.mbtiles"));
}

/// PMTiles 3 read as its specification says, by nothing that wrote it.
class Archive {
 public:
  explicit Archive(std::string bytes) : bytes_(std::move(bytes)) {
    EXPECT_EQ(bytes_.substr(0, 8), "PMTiles\x03");
    read_directory(fixed(8), fixed(16), 0);
  }
  std::uint64_t fixed(std::size_t at) const {
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < 8; ++i) value |= static_cast<std::uint64_t>(byte(at + i)) << (8 * i);
    return value;
  }
  std::uint8_t byte(std::size_t at) const { return static_cast<std::uint8_t>(bytes_.at(at)); }
  std::string metadata() const { return bytes_.substr(fixed(24), fixed(32)); }
  std::size_t size() const { return bytes_.size(); }

  std::map<std::uint64_t, std::string> tiles;
  int leaves = 0;

 private:
  std::uint64_t varint(std::size_t& at) const {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint8_t next = byte(at++);
      value |= static_cast<std::uint64_t>(next & 0x7F) << shift;
      if (next < 0x80) return value;
    }
  }
  void read_directory(std::uint64_t begin, std::uint64_t length, int depth) {
    ASSERT_LE(depth, 1);
    std::size_t at = begin;
    const std::uint64_t count = varint(at);
    std::vector<std::array<std::uint64_t, 4>> rows(count);  // id, run, length, offset
    std::uint64_t id = 0;
    for (auto& row : rows) row[0] = id += varint(at);
    for (auto& row : rows) row[1] = varint(at);
    for (auto& row : rows) row[2] = varint(at);
    std::uint64_t next = 0;
    for (auto& row : rows) {
      const std::uint64_t offset = varint(at);
      row[3] = offset == 0 ? next : offset - 1;
      next = row[3] + row[2];
    }
    EXPECT_EQ(at, begin + length);
    for (const auto& row : rows) {
      if (row[1] == 0) {
        ++leaves;
        read_directory(fixed(40) + row[3], row[2], depth + 1);
      } else {
        EXPECT_EQ(row[1], 1u);
        EXPECT_TRUE(tiles.emplace(row[0], bytes_.substr(fixed(56) + row[3], row[2])).second);
      }
    }
  }
  std::string bytes_;
};

/// The same numbers by walking the curve, as Hilbert drew it: four smaller ones, the first and the last mirrored.
std::pair<std::int64_t, std::int64_t> place_on_curve(int zoom, std::uint64_t index) {
  if (zoom == 0) return {0, 0};
  const std::int64_t half = std::int64_t{1} << (zoom - 1);
  const std::uint64_t quarter = static_cast<std::uint64_t>(half) * static_cast<std::uint64_t>(half);
  const auto [x, y] = place_on_curve(zoom - 1, index % quarter);
  switch (index / quarter) {
    case 0:
      return {y, x};
    case 1:
      return {x, y + half};
    case 2:
      return {x + half, y + half};
    default:
      return {2 * half - 1 - y, half - 1 - x};
  }
}

TEST(PmTiles, NumbersTilesAlongHilbertsCurve) {
  EXPECT_EQ(pmtiles_id(0, 0, 0), 0u);
  EXPECT_EQ(pmtiles_id(1, 0, 0), 1u);
  EXPECT_EQ(pmtiles_id(1, 0, 1), 2u);
  EXPECT_EQ(pmtiles_id(1, 1, 1), 3u);
  EXPECT_EQ(pmtiles_id(1, 1, 0), 4u);
  EXPECT_EQ(pmtiles_id(2, 0, 0), 5u);
  EXPECT_EQ(pmtiles_id(12, 3423, 1763), 19078479u) << "the example of the specification's own tests";
  for (int zoom = 0; zoom < 6; ++zoom) {
    std::uint64_t before = 0;
    for (int level = 0; level < zoom; ++level) before += std::uint64_t{1} << (2 * level);
    for (std::uint64_t index = 0; index < (std::uint64_t{1} << (2 * zoom)); ++index) {
      const auto [column, row] = place_on_curve(zoom, index);
      ASSERT_EQ(pmtiles_id(zoom, column, row), before + index) << zoom << " " << column << " " << row;
    }
  }
}

TEST(PmTiles, HoldsTheTilesOfTheMbtiles) {
  const TemporaryFolder folder;
  const RasterSpec spec = slopes();
  const Ground ground = ground_over(spec, make_raster(folder / "ortho.tif", spec));
  const std::vector<WebTile> tiles = imagery_tiles_of(ground);
  write_imagery_mbtiles(folder / "a.mbtiles", ground.imagery, tiles, {"harbour", "seen", "© somebody"}, false, 1);
  write_pmtiles(folder / "a.pmtiles", folder / "a.mbtiles", false);
  const Archive archive(read_file(folder / "a.pmtiles"));
  EXPECT_EQ(archive.tiles.size(), tiles.size());
  EXPECT_EQ(archive.leaves, 0);
  const Database database = Database::open_untrusted(folder / "a.mbtiles", 1 << 24);
  Statement rows = database.prepare("SELECT zoom_level, tile_column, tile_row, tile_data FROM tiles", "tiles");
  std::size_t count = 0;
  while (rows.step()) {
    const int zoom = static_cast<int>(rows.integer(0));
    const std::int64_t row = (std::int64_t{1} << zoom) - 1 - rows.integer(2);
    const auto blob = rows.blob(3);
    const std::string bytes(blob.begin(), blob.end());
    EXPECT_EQ(archive.tiles.at(pmtiles_id(zoom, rows.integer(1), row)), bytes);
    ++count;
  }
  EXPECT_EQ(count, tiles.size());
  for (const std::size_t at : {72U, 80U, 88U}) EXPECT_EQ(archive.fixed(at), tiles.size());
  EXPECT_EQ(archive.byte(96), 1) << "clustered";
  EXPECT_EQ(archive.byte(97), 1) << "not compressed";
  EXPECT_EQ(archive.byte(98), 1);
  EXPECT_EQ(archive.byte(99), 3) << "JPEG";
  EXPECT_EQ(archive.byte(100), tiles.front().zoom);
  EXPECT_EQ(archive.byte(101), tiles.back().zoom);
  const auto degrees = [&](std::size_t at) {
    return static_cast<std::int32_t>(static_cast<std::uint32_t>(archive.fixed(at) & 0xFFFFFFFF)) / 1e7;
  };
  const GeodeticPoint& inside = ground.tiles.front().center;
  EXPECT_LT(degrees(102), inside.lon_deg);
  EXPECT_LT(degrees(106), inside.lat_deg);
  EXPECT_GT(degrees(110), inside.lon_deg);
  EXPECT_GT(degrees(114), inside.lat_deg);
  EXPECT_THAT(archive.metadata(), ::testing::HasSubstr("\"attribution\": \"© somebody\""));
}

void make_mbtiles(const std::filesystem::path& path, int zoom, int side, const std::string& format) {
  Database database = Database::create(path, path.string());
  database.execute(
      "CREATE TABLE metadata (name TEXT, value TEXT);"
      "CREATE TABLE tiles (zoom_level INTEGER, tile_column INTEGER, tile_row INTEGER, tile_data BLOB);"
      "INSERT INTO metadata VALUES ('format', '" +
      format + "'), ('bounds', '1,2,3,4'), ('center', '2,3,5')");
  for (int column = 0; column < side; ++column) {
    for (int row = 0; row < side; ++row) {
      const std::string number = std::to_string(column) + "," + std::to_string(row);
      database.execute("INSERT INTO tiles VALUES (" + std::to_string(zoom) + "," + number + ", CAST('tile " + number +
                       std::string(static_cast<std::size_t>(row % 9), '.') + "' AS BLOB))");
    }
  }
  database.execute("CREATE INDEX i ON tiles (zoom_level, tile_column, tile_row)");
  database.close();
}

// A root directory is fetched with the header, in 16 KiB: many tiles stand in directories of their own.
TEST(PmTiles, ManyTilesStandInLeaves) {
  const TemporaryFolder folder;
  make_mbtiles(folder / "many.mbtiles", 10, 100, "jpg");
  write_pmtiles(folder / "many.pmtiles", folder / "many.mbtiles", false);
  const Archive archive(read_file(folder / "many.pmtiles"));
  EXPECT_EQ(archive.tiles.size(), 10000u);
  EXPECT_EQ(archive.leaves, 3);
  EXPECT_LE(archive.fixed(8) + archive.fixed(16), 16384u);
  EXPECT_EQ(archive.tiles.at(pmtiles_id(10, 7, 1023 - 13)), "tile 7,13....");
}

TEST(PmTiles, RefusesWhatItCannotSayRight) {
  const TemporaryFolder folder;
  make_mbtiles(folder / "png.mbtiles", 3, 2, "png");
  EXPECT_THAT(testing::error_of<DataError>([&] { write_pmtiles(folder / "x", folder / "png.mbtiles", false); }),
              ::testing::EndsWith("png.mbtiles: its tiles are not JPEG (format \"png\")"));
  make_mbtiles(folder / "empty.mbtiles", 3, 0, "jpg");
  EXPECT_THAT(testing::error_of<DataError>([&] { write_pmtiles(folder / "x", folder / "empty.mbtiles", false); }),
              ::testing::EndsWith("empty.mbtiles: holds no tile"));
  EXPECT_FALSE(std::filesystem::exists(folder / "x"));
}

}  // namespace
}  // namespace pilotage
