#include "pilotage/mapdb/map_reader.h"

#include <cmath>

#include "mapdb/small_map.h"
#include "testing/key_pair.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/map_signing.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

bool same_height(float a, float b) {
  return (std::isnan(a) && std::isnan(b)) || a == b;
}

void expect_same_descriptors(const TileDescriptors& got, const TileDescriptors& want) {
  EXPECT_EQ(got.tile_id, want.tile_id);
  EXPECT_EQ(got.level, want.level);
  EXPECT_EQ(got.window, want.window);
  EXPECT_EQ(got.features.descriptor_bytes, want.features.descriptor_bytes);
  EXPECT_EQ(got.features.descriptors, want.features.descriptors);
  ASSERT_EQ(got.features.size(), want.features.size());
  for (std::size_t i = 0; i < want.features.size(); ++i) {
    EXPECT_EQ(got.features.features[i].x_px, want.features.features[i].x_px);
    EXPECT_EQ(got.features.features[i].y_px, want.features.features[i].y_px);
    EXPECT_EQ(got.features.features[i].octave, want.features.features[i].octave);
  }
  ASSERT_EQ(got.ground_height_m.size(), want.ground_height_m.size());
  for (std::size_t i = 0; i < want.ground_height_m.size(); ++i) {
    EXPECT_TRUE(same_height(got.ground_height_m[i], want.ground_height_m[i]))
        << got.ground_height_m[i] << " " << want.ground_height_m[i];
  }
}

class MapReaderTest : public ::testing::Test {
 protected:
  MapReaderTest() : map_(testing::make_small_map()), path_(folder_ / "map.gpkg") {
    map_.content_digest = testing::write_map(path_, map_);
  }
  testing::TemporaryFolder folder_;
  testing::SmallMap map_;
  std::filesystem::path path_;
};

TEST_F(MapReaderTest, RefusesAMapInfoOfMoreRowsThanAnyMapHas) {
  Database database = Database::create(path_, "map.gpkg");
  const auto add_rows_up_to = [&](std::size_t rows) {
    database.execute(
        "WITH RECURSIVE n(i) AS (SELECT (SELECT count(*) FROM map_info) UNION ALL SELECT i + 1 FROM n WHERE i + 1 < " +
        std::to_string(rows) + ") INSERT INTO map_info (key, value) SELECT 'row ' || i, '' FROM n");
  };
  add_rows_up_to(kMaxInfoEntries);
  EXPECT_EQ(MapReader::open_unverified(path_).info().entries.size(), kMaxInfoEntries);
  add_rows_up_to(kMaxInfoEntries + 1);
  EXPECT_THAT([&] { MapReader::open_unverified(path_); },
              ThrowsMessage<DataError>(HasSubstr("map_info has more than 100000 rows")));
}

TEST_F(MapReaderTest, GivesBackTilesAndTheirValues) {
  MapReader reader = MapReader::open_unverified(path_);
  const std::vector<MapTile> tiles = reader.tiles();
  ASSERT_EQ(tiles.size(), map_.tiles.size());
  EXPECT_EQ(reader.tiles(1).size(), map_.tiles.size() / 2);
  ASSERT_EQ(reader.tile_columns().size(), 4U);
  EXPECT_EQ(reader.tile_columns()[2].name, "rivals");
  EXPECT_EQ(reader.tile_columns()[2].type, MapColumnType::kInteger);
  EXPECT_EQ(reader.tile_columns()[3].description, "scored, flat or too_little_ground.");
  for (std::size_t i = 0; i < tiles.size(); ++i) {
    const MapTile& want = map_.tiles[i];
    const MapTile got = reader.tile(want.tile_id).value();
    EXPECT_EQ(got.tile_id, tiles[i].tile_id);
    EXPECT_EQ(got.level, want.level);
    EXPECT_EQ(got.column, want.column);
    EXPECT_EQ(got.row, want.row);
    EXPECT_EQ(got.bounds.min_x_m, want.bounds.min_x_m);
    EXPECT_EQ(got.bounds.max_y_m, want.bounds.max_y_m);
    EXPECT_EQ(got.center.lon_deg, want.center.lon_deg);
    EXPECT_EQ(got.center.lat_deg, want.center.lat_deg);
    EXPECT_EQ(got.enu_from_grid, want.enu_from_grid);
    std::vector<MapValue> values = map_.values[i];
    if (want.tile_id == 1) values[0] = std::monostate{};  // NaN is stored as NULL
    EXPECT_EQ(reader.tile_values(want.tile_id), values);
  }
  EXPECT_FALSE(reader.tile(99).has_value());
  EXPECT_FALSE(reader.tile_values(99).has_value());
}

TEST_F(MapReaderTest, SaysHowFarTheMapMayBeOffWhereItKnows) {
  EXPECT_FALSE(MapReader::open_unverified(path_).map_sigma_m(map_.tiles[0].tile_id)) << "no such column";
  map_.header.tile_columns.push_back({"map_sigma_m", MapColumnType::kReal, "Error of the map [m]"});
  for (std::vector<MapValue>& values : map_.values) values.emplace_back(5.25);
  map_.values[0].back() = std::monostate{};
  map_.values[2].back() = -1.0;
  const std::filesystem::path path = folder_ / "captured.gpkg";
  testing::write_map(path, map_);
  MapReader reader = MapReader::open_unverified(path);
  EXPECT_FALSE(reader.map_sigma_m(map_.tiles[0].tile_id));
  EXPECT_EQ(reader.map_sigma_m(map_.tiles[1].tile_id), 5.25);
  EXPECT_FALSE(reader.map_sigma_m(9999)) << "no such tile";
  EXPECT_THAT([&] { reader.map_sigma_m(map_.tiles[2].tile_id); },
              ThrowsMessage<DataError>(HasSubstr("map_sigma_m is no number from 0 to 100")));
  map_.values[2].back() = 7.5;
  const std::filesystem::path sound = folder_ / "sound.gpkg";
  testing::write_map(sound, map_);
  EXPECT_EQ(MapReader::open_unverified(sound).largest_map_sigma_m(), 7.5);
}

TEST_F(MapReaderTest, GivesBackDescriptorsAndChips) {
  MapReader reader = MapReader::open_unverified(path_);
  for (const TileDescriptors& want : map_.descriptors) {
    const auto got = reader.descriptors(want.tile_id, want.level);
    ASSERT_NE(got, nullptr);
    expect_same_descriptors(*got, want);
  }
  EXPECT_EQ(reader.descriptors(0, 1), nullptr);
  EXPECT_TRUE(reader.has_chips());
  for (const MapChip& want : map_.chips) {
    const auto got = reader.chip(want.tile_id, want.level);
    ASSERT_TRUE(got.has_value());
    EXPECT_EQ(got->window, want.window);
    EXPECT_EQ(got->encoding, want.encoding);
    EXPECT_EQ(got->data, want.data);
  }
}

TEST_F(MapReaderTest, GivesBackInfoAndLevels) {
  const MapReader reader = MapReader::open_unverified(path_);
  EXPECT_EQ(reader.info().crs.name, map_.header.crs.name);
  EXPECT_EQ(reader.info().crs.wkt, map_.header.crs.wkt);
  EXPECT_EQ(reader.info().crs.authority, "EPSG:32750");
  std::vector<MapInfoEntry> want = map_.info;
  want.insert(want.begin(), {"schema_version", "1"});
  want.push_back({"content_digest", map_.content_digest});
  EXPECT_EQ(reader.info().entries, want);
  ASSERT_EQ(reader.levels().size(), 2U);
  EXPECT_TRUE(std::isnan(reader.levels()[0].min_agl_m));
  EXPECT_EQ(reader.levels()[1].min_agl_m, 60);
  const MapLevel* level = reader.find_level(1);
  ASSERT_NE(level, nullptr);
  EXPECT_EQ(level->matrix.map_from_pixel, map_.header.levels[1].matrix.map_from_pixel);
  EXPECT_EQ(level->matrix.matrix_width(), 3);
  EXPECT_NEAR(level->max_tile_radius_m, 32 * std::sqrt(2), 0.05);
  EXPECT_EQ(reader.find_level(2), nullptr);
}

TEST_F(MapReaderTest, SeveralReadersShareAFileAndAnyName) {
  const auto odd = folder_ / "a b%20?#ü.gpkg";
  std::filesystem::copy(path_, odd);
  MapReader first = MapReader::open_unverified(odd);
  MapReader second = MapReader::open_unverified(odd);
  EXPECT_EQ(first.tiles().size(), second.tiles().size());
}

TEST_F(MapReaderTest, LeavesNothingBesideTheFile) {
  {
    MapReader reader = MapReader::open_unverified(path_);
    static_cast<void>(reader.descriptors(0, 0));
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
}

TEST_F(MapReaderTest, ReadsTheBytesThatWereSigned) {
  const std::string key = testing::generate_key_pair(folder_ / "a.key", folder_ / "a.pub");
  EXPECT_THROW(MapReader::open(path_, {key}), DataError) << "there is no signature";
  sign_file(path_, folder_ / "a.key");
  const SignedMap checked = read_signed_map(path_, {key});
  MapReader reader = MapReader::open(path_, {key});
  write_file(path_, std::string(read_file(path_).size(), 'x'), true);  // what another program does after the check
  MapReader other = MapReader::open(checked);
  for (const MapTile& tile : map_.tiles) {
    ASSERT_NE(reader.descriptors(tile.tile_id, tile.level), nullptr);
    EXPECT_EQ(reader.descriptors(tile.tile_id, tile.level)->features.descriptors,
              other.descriptors(tile.tile_id, tile.level)->features.descriptors);
  }
  EXPECT_THROW(MapReader::open(path_, {key}), IntegrityError);
}

TEST_F(MapReaderTest, RefusesAForeignMapBeforeItIsParsed) {
  const std::string key = testing::generate_key_pair(folder_ / "a.key", folder_ / "a.pub");
  sign_file(path_, folder_ / "a.key");
  write_file(path_, "no map at all", true);
  EXPECT_THROW(MapReader::open(path_, {key}), IntegrityError);
  EXPECT_THROW(MapReader::open(path_, {}), UsageError);
}

TEST_F(MapReaderTest, AnotherTakesItsPlace) {
  const std::string key = testing::generate_key_pair(folder_ / "a.sec", folder_ / "a.pub");
  sign_file(path_, folder_ / "a.sec");
  std::filesystem::copy_file(path_, folder_ / "other.gpkg");
  MapReader reader = MapReader::open(path_, {key});
  const std::vector<MapTile> tiles = reader.tiles();
  for (int i = 0; i < 3; ++i) {
    reader = i % 2 == 0 ? MapReader::open_unverified(folder_ / "other.gpkg") : MapReader::open(path_, {key});
    EXPECT_EQ(reader.tiles().size(), tiles.size());
    EXPECT_TRUE(reader.tile(tiles.front().tile_id)) << "statements of the one before are gone with it";
    EXPECT_THAT(reader.name(), HasSubstr(i % 2 == 0 ? "other.gpkg" : "map.gpkg"));
  }
}

TEST(MapReader, SaysWhatIsNotAMap) {
  const testing::TemporaryFolder folder;
  EXPECT_THAT([&] { MapReader::open_unverified(folder / "none.gpkg"); },
              ThrowsMessage<DataError>(HasSubstr("none.gpkg: cannot be read")));
  EXPECT_THAT([&] { MapReader::open_unverified(folder.path()); }, ThrowsMessage<DataError>(HasSubstr("is a folder")));
  { Database::create(folder / "other.gpkg", "other").execute("CREATE TABLE a (b)"); }
  EXPECT_THAT([&] { MapReader::open_unverified(folder / "other.gpkg"); },
              ThrowsMessage<DataError>(HasSubstr("is not a GeoPackage")));
}

// A map of tomorrow may hold other tables; the version must be the first thing it is judged by.
TEST_F(MapReaderTest, RefusesANewerSchema) {
  Database::create(path_, "map")
      .execute(
          "UPDATE map_info SET value = '3' WHERE key = 'schema_version'; ALTER TABLE pilotage_levels RENAME COLUMN "
          "gsd_m TO g");
  EXPECT_THAT([&] { MapReader::open_unverified(path_); },
              ThrowsMessage<DataError>(HasSubstr("schema version 3; this program reads up to")));
}

TEST_F(MapReaderTest, NamesFileTableAndTileOfDamage) {
  const auto expect = [&](const char* sql, const auto& read, const char* message) {
    const auto copy = folder_ / "copy.gpkg";
    std::filesystem::copy_file(path_, copy, std::filesystem::copy_options::overwrite_existing);
    Database::create(copy, "map")
        .execute(std::string("DROP TRIGGER rtree_tiles_geom_update3;"
                             "DROP TRIGGER rtree_tiles_geom_update4;") +
                 sql);
    MapReader reader = MapReader::open_unverified(copy);
    EXPECT_THAT([&] { read(reader); }, ThrowsMessage<DataError>(HasSubstr(message))) << sql;
  };
  const auto descriptors = [](MapReader& reader) { static_cast<void>(reader.descriptors(3, 0)); };
  expect("UPDATE pilotage_descriptors SET descriptors = zeroblob(159) WHERE tile_id = 3", descriptors,
         "copy.gpkg: tile 3, level 0: descriptor blob has 159 bytes, expected 5 × 16");
  expect("UPDATE pilotage_descriptors SET keypoints = zeroblob(1) WHERE tile_id = 3", descriptors,
         "tile 3, level 0: keypoint blob has 1 bytes, expected 5 × 8");
  expect("UPDATE pilotage_descriptors SET count = -1 WHERE tile_id = 3", descriptors,
         "pilotage_descriptors: column count holds -1, outside [0, ");
  expect("UPDATE pilotage_descriptors SET count = 'many' WHERE tile_id = 3", descriptors,
         "pilotage_descriptors: column count holds text, expected an integer");
  expect("UPDATE pilotage_descriptors SET window_width_px = 1 WHERE tile_id = 3", descriptors, "key point");
  expect(
      "UPDATE tiles SET max_x_m = min_x_m WHERE tile_id = 2", [](MapReader& reader) { reader.tile(2); },
      "copy.gpkg: tile 2: bounds (");
  expect(
      "UPDATE tiles SET east_per_x = 0 WHERE tile_id = 2", [](MapReader& reader) { reader.tile(2); },
      "copy.gpkg: tile 2: matrix");
  // Found by the fuzzer: the error came while a matrix was half filled and ended the program.
  expect(
      "UPDATE tiles SET east_per_y = 'x' WHERE tile_id = 2", [](MapReader& reader) { reader.tile(2); },
      "tiles: column east_per_y holds text, expected a number");
  expect(
      "UPDATE pilotage_chips SET data = x'00' WHERE tile_id = 2", [](MapReader& reader) { reader.chip(2, 0); },
      "copy.gpkg: tile 2, level 0: chip blob has 1 bytes, expected 4 × 3");
}

TEST_F(MapReaderTest, DoesNotRunWhatTheFileDefines) {
  const auto replace_tiles = [&](const std::string& sql) {
    const auto copy = folder_ / "copy.gpkg";
    std::filesystem::copy_file(path_, copy, std::filesystem::copy_options::overwrite_existing);
    Database::create(copy, "map").execute(sql);
    return copy;
  };
  EXPECT_THAT(
      [&] {
        MapReader::open_unverified(
            replace_tiles("DROP TABLE map_info; CREATE VIEW map_info AS SELECT 1 id, 2 key, 3 value"));
      },
      ThrowsMessage<DataError>(HasSubstr("has no table map_info")));
  EXPECT_THAT([&] { MapReader::open_unverified(replace_tiles("DROP TABLE pilotage_tile_centers")); },
              ThrowsMessage<DataError>(HasSubstr("has no R-tree pilotage_tile_centers")));
}

}  // namespace
}  // namespace pilotage
