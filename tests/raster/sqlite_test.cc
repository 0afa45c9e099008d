// GeoPackages of imagery that somebody made to be read for ever. A test that does not end is how these fail.
#include "pilotage/mapdb/sqlite.h"

#include "raster/raster_maker.h"
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
    const std::int64_t root =
        table == std::string("sqlite_master")
            ? 1
            : Database::open_untrusted(path_, 1 << 20)
                  .query_integer("SELECT rootpage FROM sqlite_master WHERE name = '" + std::string(table) + "'");
    testing::ForgedFile file(read_file(path_));
    file.read_in_circles(static_cast<std::uint32_t>(root), 4);
    write_file(forged_, file.bytes(), true);
    for (const std::string& dataset : {forged_.string(), "GPKG:" + forged_.string() + ":ortho"}) {
      try {
        open_raster(dataset);
      } catch (const DataError& error) {
        refused += std::string(error.what()).find("takes SQLite more steps") != std::string::npos ? 1 : 0;
      }
    }
  }
  EXPECT_EQ(refused, 10) << "all but the tiles, which are read by their index";
}

// One step of SQLite's machine each, and minutes.
TEST_F(ForgedImagery, FormulasOfColumnsAreNotRun) {
  std::filesystem::copy_file(path_, forged_);
  Database::create(forged_, "forged")
      .execute(
          "ALTER TABLE gpkg_contents ADD COLUMN slow AS "
          "(instr(hex(zeroblob(30000000)), hex(zeroblob(10000000)) || '1'))");
  EXPECT_THAT([&] { open_raster(forged_.string()); },
              ThrowsMessage<DataError>(HasSubstr("forged.gpkg: the table \"gpkg_contents\" has generated columns")));
}

}  // namespace
}  // namespace pilotage
