// Maps that somebody made to be read for ever, or into all memory: each reader refuses them after a bounded cost. A
// test that does not end is how these fail.

#include "testing/forged_map.h"

#include <functional>

#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/map_inspect.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_schema.h"
#include "pilotage/mapdb/map_verify.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ForgedMap : public ::testing::Test {
 protected:
  ForgedMap() : path_(folder_ / "map.gpkg"), forged_(folder_ / "forged.gpkg") {
    testing::write_map(path_, testing::make_small_map());
  }

  void forge_by_sql(const std::string& sql) {
    std::filesystem::copy_file(path_, forged_, std::filesystem::copy_options::overwrite_existing);
    Database::create(forged_, "map").execute(sql);
  }

  /// The table's pages lead in circles below its root.
  void forge_circles(const std::string& table, int depth) {
    write_file(forged_, testing::bytes_in_circles(path_, table, depth), true);
  }

  /// Asks all that commands ask of a map. Throws what the first throws; verify must find something, too.
  void read_forged() const {
    EXPECT_FALSE(verify_map(forged_).ok());
    inspect_map(forged_);
    MapReader reader = MapReader::open_unverified(forged_);
    const std::vector<MapTile> tiles = reader.tiles();
    for (const MapTile& tile : tiles) {
      reader.tiles_near(tile.center, 100);
      reader.tiles_near(tile.bounds.center_m(), 100);
      reader.tile_values(tile.tile_id);
      reader.descriptors(tile.tile_id, tile.level);
      reader.chip(tile.tile_id, tile.level);
    }
  }

  testing::TemporaryFolder folder_;
  std::filesystem::path path_;
  std::filesystem::path forged_;
};

TEST_F(ForgedMap, PagesThatAreReadManyTimesEnd) {
  for (const char* table : {"sqlite_master", "pilotage_levels", "tiles", "map_info", "gpkg_data_columns",
                            "gpkg_geometry_columns", "gpkg_extensions", "pilotage_descriptors", "pilotage_chips"}) {
    for (const int depth : {1, 2, 4, 8}) {
      SCOPED_TRACE(std::string(table) + " " + std::to_string(depth));
      forge_circles(table, depth);
      try {
        read_forged();
      } catch (const DataError& error) {
        EXPECT_THAT(error.what(), HasSubstr("forged.gpkg: "));
      }
    }
  }
}

TEST_F(ForgedMap, ReadersSayThatPagesAreReadInCircles) {
  forge_circles("pilotage_levels", 4);
  EXPECT_THAT([&] { MapReader::open_unverified(forged_); },
              ThrowsMessage<DataError>(HasSubstr("pilotage_levels has more than 64 rows")));
  forge_circles("tiles", 4);
  EXPECT_THAT([&] { MapReader::open_unverified(forged_).tiles(); },
              ThrowsMessage<DataError>(HasSubstr("more rows than a file of")));
  EXPECT_THAT([&] { inspect_map(forged_); }, ThrowsMessage<DataError>(HasSubstr("more steps than a sound map")));
}

TEST_F(ForgedMap, ValuesThatTakeForEverAreNotComputed) {
  const std::string forever = "instr(hex(zeroblob(30000000)), hex(zeroblob(10000000)) || 1)";
  const auto declare = [&](const std::string& table, const std::string& old_text, const std::string& new_text) {
    forge_by_sql("PRAGMA writable_schema = 1; UPDATE sqlite_master SET sql = replace(sql, '" + old_text + "', '" +
                 new_text + "') WHERE name = '" + table + "'");
    EXPECT_THAT([&] { MapReader::open_unverified(forged_); },
                ThrowsMessage<DataError>(HasSubstr(table + " is not declared as a map declares it")))
        << table;
    EXPECT_FALSE(verify_map(forged_).ok());
    EXPECT_THROW(inspect_map(forged_), DataError);
  };
  declare("map_info", "value TEXT NOT NULL", "v0 TEXT NOT NULL, value TEXT AS (v0 || substr(key, " + forever + "))");
  declare("pilotage_levels", "max_tile_radius_m REAL NOT NULL", "r0 REAL NOT NULL, max_tile_radius_m AS (r0 + 1)");
  declare("pilotage_descriptors", "count INTEGER NOT NULL", "c0 INTEGER NOT NULL, count INTEGER AS (c0 + 1)");
  declare("tiles", "level INTEGER NOT NULL", "level INTEGER NOT NULL CHECK (level + 1)");
  declare("route", "geom LINESTRING NOT NULL", "geom LINESTRING NOT NULL, \"x\" REAL DEFAULT 1");
  declare("rtree_tiles_geom_node", "data", "data AS (1)");
  declare("gpkg_data_columns", "description TEXT", "description TEXT COLLATE NOCASE");
}

// What SQLite computes by itself when a table is read or checked: indices of expressions, statistics.
TEST_F(ForgedMap, NothingElseMayBeDeclared) {
  for (const char* sql : {"CREATE INDEX stranger ON tiles (abs(level))", "CREATE VIEW stranger AS SELECT 1", "ANALYZE",
                          "CREATE TABLE stranger (a)", "CREATE VIRTUAL TABLE stranger USING rtree(id, a, b)",
                          "CREATE TRIGGER stranger AFTER INSERT ON tiles BEGIN SELECT 1; END"}) {
    forge_by_sql(sql);
    EXPECT_THAT([&] { MapReader::open_unverified(forged_); }, ThrowsMessage<DataError>(HasSubstr(", which no map has")))
        << sql;
    EXPECT_FALSE(verify_map(forged_).ok());
  }
}

TEST_F(ForgedMap, EveryMapOfThisProgramIsDeclaredAsItSays) {
  const Database database = Database::open_untrusted(path_, kMaxMapBlobBytes);
  const MapDeclarations declared = read_declarations(database);
  EXPECT_NO_THROW(check_declarations(declared, "map"));
  EXPECT_EQ(declared.size(), 27U) << "13 tables, 2 R-trees and the 6 tables that they keep their nodes in, 6 triggers";
}

// When it loads a schema SQLite reads the statistics of ANALYZE by itself, before anybody can look at their table: two
// thousand values of half a second each.
TEST_F(ForgedMap, StatisticsAreNotRead) {
  forge_by_sql(
      "ANALYZE; WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 2000) "
      "INSERT INTO sqlite_stat1 SELECT 'tiles', NULL, '12' FROM n; PRAGMA writable_schema = 1; UPDATE sqlite_master "
      "SET "
      "sql = 'CREATE TABLE sqlite_stat1(tbl, idx, s0, stat AS (substr(s0, instr(hex(zeroblob(60000)), "
      "hex(zeroblob(20000)) || 1))))' WHERE name = 'sqlite_stat1'");
  EXPECT_THAT([&] { MapReader::open_unverified(forged_); },
              ThrowsMessage<DataError>(HasSubstr("declares sqlite_stat1, which no map has")));
  EXPECT_FALSE(verify_map(forged_).ok());
}

// SQLite's integrity check calls itself once for each page of a chain: 60,000 calls need more stack than a thread has.
TEST_F(ForgedMap, AnIndexOfOneLongChainIsChecked) {
  Database::create(path_, "map").execute("PRAGMA page_size = 512; VACUUM");
  const std::int64_t root =
      Database::open_untrusted(path_, kMaxMapBlobBytes)
          .query_integer("SELECT rootpage FROM sqlite_master WHERE name = 'sqlite_autoindex_map_info_1'");
  testing::ForgedFile file(read_file(path_));
  file.lengthen_index(static_cast<std::uint32_t>(root), 60'000);
  write_file(forged_, file.bytes(), true);
  EXPECT_FALSE(verify_map(forged_).ok());
}

TEST_F(ForgedMap, PipesAreNotWaitedFor) {
  const std::filesystem::path pipe = folder_ / "pipe.gpkg";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_FALSE(declares_map(pipe));
  EXPECT_THROW(inspect_map(pipe), DataError);
  EXPECT_THROW(MapReader::open_unverified(pipe), DataError);
}

// A tree of distinct nodes, each of which names the next one as many times as fit: 51^39 visits, none of which gives a
// row. SQLite walks it within one step of its machine.
TEST_F(ForgedMap, AnRtreeWhoseNodesAreVisitedManyTimesEnds) {
  forge_by_sql("");
  {
    Database database = Database::create(forged_, "map");
    const std::int64_t bytes =
        database.query_integer("SELECT length(data) FROM pilotage_tile_centers_node WHERE nodeno = 1");
    const std::int64_t cells = (bytes - 4) / 24;
    Statement put = database.prepare("INSERT OR REPLACE INTO pilotage_tile_centers_node VALUES (?, ?)");
    constexpr int kDepth = 39;
    for (int node = 1; node <= kDepth + 1; ++node) {
      std::vector<std::uint8_t> data(static_cast<std::size_t>(bytes), 0);
      const auto put_16 = [&](std::size_t at, std::int64_t value) {
        data[at] = static_cast<std::uint8_t>(value >> 8);
        data[at + 1] = static_cast<std::uint8_t>(value);
      };
      put_16(0, node == 1 ? kDepth : 0);
      put_16(2, cells);
      for (std::int64_t cell = 0; cell < cells; ++cell) {
        const auto at = static_cast<std::size_t>(4 + 24 * cell);
        put_16(at + 6, node + 1);
        if (node == kDepth + 1) continue;  // boxes at (0, 0), where no tile is
        const std::uint8_t earth[16] = {0xC3, 0x34, 0, 0, 0x43, 0x34, 0, 0, 0xC2, 0xB4, 0, 0, 0x42, 0xB4, 0, 0};
        std::copy(std::begin(earth), std::end(earth), data.begin() + static_cast<std::ptrdiff_t>(at) + 8);
      }
      put.bind(1, std::int64_t{node}).bind(2, std::span<const std::uint8_t>(data));
      put.run();
    }
  }
  MapReader reader = MapReader::open_unverified(forged_);
  EXPECT_THAT([&] { reader.tiles_near(reader.tiles().front().center, 100); },
              ThrowsMessage<DataError>(HasSubstr("more steps than a sound map")));
  EXPECT_FALSE(verify_map(forged_).ok());
  // What is watched ends sooner, and for the reason that its watch gives.
  int calls = 0;
  reader.watch([&] {
    if (++calls == 5) throw UsageError("enough");
  });
  EXPECT_THROW(reader.tiles_near(reader.tile(0)->center, 100), UsageError);
  EXPECT_EQ(calls, 5);
  reader.watch({});
  EXPECT_THROW(reader.tiles_near(reader.tile(0)->center, 100), DataError);
}

// Text of 60 kB in each row of a table that is read in circles: steps are few, bytes are many.
TEST_F(ForgedMap, LongValuesCountByTheirBytes) {
  forge_by_sql("INSERT INTO map_info (id, key, value) VALUES (500, 'long', printf('%.60000c', 'x'))");
  std::filesystem::copy_file(forged_, path_, std::filesystem::copy_options::overwrite_existing);
  forge_circles("map_info", 3);
  EXPECT_THROW(MapReader::open_unverified(forged_), DataError);
  EXPECT_THROW(inspect_map(forged_), DataError);
  EXPECT_FALSE(verify_map(forged_).ok());
}

TEST_F(ForgedMap, RandomForgeriesGiveAMapOrAnError) {
  const std::string sound = read_file(path_);
  Random random(35);
  int refused = 0;
  for (int i = 0; i < 100; ++i) {
    testing::ForgedFile file(sound);
    for (std::uint64_t changes = 1 + random.below(3); changes > 0; --changes) file.change_at_random(random);
    write_file(forged_, file.bytes(), true);
    try {
      static_cast<void>(verify_map(forged_));
      inspect_map(forged_);
      MapReader reader = MapReader::open_unverified(forged_);
      for (const MapTile& tile : reader.tiles()) reader.tiles_near(tile.center, 100);
    } catch (const DataError& error) {
      EXPECT_THAT(error.what(), HasSubstr("forged.gpkg"));
      ++refused;
    }
  }
  EXPECT_GT(refused, 20);
}

}  // namespace
}  // namespace pilotage
