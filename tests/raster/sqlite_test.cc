// GeoPackages of imagery that somebody made to be read for ever. A test that does not end is how these fail.
#include "pilotage/mapdb/sqlite.h"

#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/forged_map.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/raster/gdal_handle.h"
#include "pilotage/raster/gdal_sqlite.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

class ForgedImagery : public ::testing::Test {
 protected:
  ForgedImagery() : path_(folder_ / "ortho.gpkg"), forged_(folder_ / "forged.gpkg") {
    const DatasetPtr tiff = open_raster(testing::make_raster(folder_ / "ortho.tif", {}));
    const GdalErrors errors;
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("GPKG");
    const DatasetPtr written(driver->CreateCopy(path_.c_str(), tiff.get(), FALSE, nullptr, nullptr, nullptr));
    EXPECT_NE(written, nullptr) << errors.message();
  }

  void forge_by_sql(const std::string& sql) {
    std::filesystem::copy_file(path_, forged_, std::filesystem::copy_options::overwrite_existing);
    Database::create(forged_, "forged").execute(sql);
  }
  std::string error() const {
    return testing::error_of<DataError>([&] { open_raster(forged_.string()); });
  }

  testing::TemporaryFolder folder_;
  std::filesystem::path path_;
  std::filesystem::path forged_;
};

TEST_F(ForgedImagery, ASoundOneIsWithinItsCost) {
  EXPECT_EQ(open_raster(path_.string())->GetRasterXSize(), 60);
  EXPECT_EQ(open_raster("GPKG:" + path_.string() + ":ortho")->GetRasterXSize(), 60);
}

TEST_F(ForgedImagery, PagesThatAreReadInCirclesEnd) {
  int refused = 0;
  for (const char* table :
       {"sqlite_master", "gpkg_contents", "gpkg_extensions", "gpkg_tile_matrix", "gpkg_tile_matrix_set", "ortho"}) {
    SCOPED_TRACE(table);
    write_file(forged_, testing::bytes_in_circles(path_, table, 4), true);
    for (const std::string& dataset : {forged_.string(), "GPKG:" + forged_.string() + ":ortho"}) {
      try {
        open_raster(dataset);
      } catch (const DataError& error) {
        refused += std::string(error.what()).find("takes SQLite more") != std::string::npos ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(refused, 10) << "all but the tiles, which are read by their index";
}

// Steps are few and bytes are many.
TEST_F(ForgedImagery, LongValuesThatAreReadInCirclesEnd) {
  forge_by_sql("UPDATE gpkg_contents SET description = hex(zeroblob(500000))");
  const std::filesystem::path long_one = folder_ / "long.gpkg";
  std::filesystem::rename(forged_, long_one);
  write_file(forged_, testing::bytes_in_circles(long_one, "gpkg_contents", 3), true);
  EXPECT_THAT(error(), HasSubstr("takes SQLite more"));
}

constexpr const char* kSlow =
    "ALTER TABLE gpkg_contents ADD COLUMN slow AS (instr(hex(zeroblob(30000000)), hex(zeroblob(10000000)) || '1'))";

// One step of SQLite's machine each, and minutes.
TEST_F(ForgedImagery, FormulasOfColumnsAreNotRun) {
  forge_by_sql(kSlow);
  EXPECT_THAT(error(), HasSubstr("forged.gpkg: the table \"gpkg_contents\" has generated columns"));
}

// Of such a table SQLite tells no columns, and must not stop at it.
TEST_F(ForgedImagery, ATableOfAnUnknownModuleHidesNothing) {
  forge_by_sql(
      "PRAGMA writable_schema = ON; INSERT INTO sqlite_master VALUES ('table', 'a', 'a', 0, "
      "'CREATE VIRTUAL TABLE a USING nomodule(x)')");
  EXPECT_EQ(error(), "");
  forge_by_sql(std::string(kSlow) +
               "; PRAGMA writable_schema = ON; INSERT INTO sqlite_master VALUES ('table', 'a', 'a', 0, "
               "'CREATE VIRTUAL TABLE a USING nomodule(x)')");
  EXPECT_THAT(error(), HasSubstr("has generated columns"));
}

TEST_F(ForgedImagery, WhatDescribesTablesIsNoView) {
  forge_by_sql(
      "ALTER TABLE gpkg_tile_matrix RENAME TO kept; CREATE VIEW gpkg_tile_matrix AS WITH RECURSIVE c(n) AS (SELECT 1 "
      "UNION ALL SELECT n + 1 FROM c) SELECT kept.* FROM c, kept WHERE n = 1 OR n < 0");
  EXPECT_THAT(error(), HasSubstr("has the view \"gpkg_tile_matrix\""));
}

TEST_F(ForgedImagery, WhatDescribesTablesIsNoTree) {
  forge_by_sql("CREATE VIRTUAL TABLE gpkg_tree USING rtree(id, west, east)");
  EXPECT_THAT(error(), HasSubstr("a virtual table describes the others"));
}

TEST_F(ForgedImagery, AViewOfTilesJoinsTablesAndNoMore) {
  forge_by_sql(
      "CREATE VIEW tiles AS SELECT * FROM ortho; "
      "CREATE VIEW spatial_ref_sys AS SELECT hex(srs_name) FROM gpkg_spatial_ref_sys");
  EXPECT_EQ(error(), "");
  forge_by_sql("CREATE VIEW tiles AS SELECT hex(tile_data) FROM ortho");
  EXPECT_THAT(error(), HasSubstr("has the view \"tiles\""));
}

TEST_F(ForgedImagery, NothingIsWrittenBesideAFileOfALog) {
  std::string bytes = read_file(path_);
  bytes[18] = bytes[19] = 2;  // it says that it has a write-ahead log
  write_file(forged_, bytes, false);
  EXPECT_EQ(error(), "");
  EXPECT_FALSE(std::filesystem::exists(forged_.string() + "-wal"));
  EXPECT_FALSE(std::filesystem::exists(forged_.string() + "-shm"));
}

TEST_F(ForgedImagery, OneInsideAnotherFileIsToBeUnpacked) {
  const std::uintmax_t bytes = std::filesystem::file_size(path_);
  EXPECT_THAT([&] { open_raster("/vsisubfile/0_" + std::to_string(bytes) + "," + path_.string()); },
              ThrowsMessage<DataError>(HasSubstr("is a database inside another file; unpack it first")));
}

}  // namespace
}  // namespace pilotage
