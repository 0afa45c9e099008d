// The seeds of the map fuzzer. To write them anew after a change of the format:
//   PILOTAGE_WRITE_CORPUS=1 build/dev/bin/test_mapdb --gtest_filter='MapCorpus.*'

#include <cstdlib>

#include "mapdb/small_map.h"
#include "testing/source_folder.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/output_file.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_verify.h"

namespace pilotage {
namespace {

/// Small pages, so that the seed is small and a flipped bit more often hits something.
void write_seed(const std::filesystem::path& path, const testing::SmallMapOptions& options) {
  testing::write_map(path, testing::make_small_map(options), true);
  Database database = Database::create(path, "seed");
  database.execute("PRAGMA page_size=512; VACUUM;");
  database.close();
}

TEST(MapCorpus, SeedsAreWholeMaps) {
  const std::filesystem::path folder = testing::source_folder() / "tests/fuzz/corpus/map";
  testing::SmallMapOptions tiny;
  tiny.columns = tiny.rows = tiny.levels = 1;
  tiny.chips = false;
  testing::SmallMapOptions small;
  small.columns = 2;
  if (std::getenv("PILOTAGE_WRITE_CORPUS") != nullptr) {
    write_seed(folder / "one_tile", tiny);
    write_seed(folder / "two_levels", small);
  }
  std::uintmax_t bytes = 0;
  for (const auto& [name, options] : {std::pair{"one_tile", tiny}, {"two_levels", small}}) {
    EXPECT_TRUE(verify_map(folder / name).ok()) << name;
    EXPECT_EQ(MapReader::open_unverified(folder / name).tiles().size(), testing::make_small_map(options).tiles.size());
    bytes += std::filesystem::file_size(folder / name);
  }
  EXPECT_LE(bytes, 100000U);
}

// Another program may pack the file anew without changing a row.
TEST(MapCorpus, AVacuumedMapIsStillWhole) {
  const testing::TemporaryFolder folder;
  write_seed(folder / "map.gpkg", {});
  EXPECT_TRUE(verify_map(folder / "map.gpkg").ok());
}

}  // namespace
}  // namespace pilotage
