#include "pilotage/mapdb/map_inspect.h"

#include "mapdb/small_map.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

TEST(InspectMap, CountsWhatIsThere) {
  const testing::TemporaryFolder folder;
  testing::write_map(folder / "map.gpkg", testing::make_small_map());
  const MapSummary summary = inspect_map(folder / "map.gpkg");
  EXPECT_EQ(summary.file, "map.gpkg");
  EXPECT_EQ(summary.file_bytes, static_cast<std::int64_t>(std::filesystem::file_size(folder / "map.gpkg")));
  EXPECT_EQ(summary.tiles, 12);
  EXPECT_EQ(summary.route_lines, 1);
  EXPECT_EQ(summary.legs, 2);
  ASSERT_EQ(summary.levels.size(), 2U);
  EXPECT_EQ(summary.levels[1].tiles, 6);
  EXPECT_EQ(summary.levels[1].tiles_with_descriptors, 6);
  EXPECT_EQ(summary.levels[1].descriptors, 30);
  EXPECT_EQ(summary.levels[1].descriptor_blob_bytes, 30 * (8 + 16));
  EXPECT_EQ(summary.levels[1].chip_bytes, 6 * 12);
  EXPECT_EQ(summary.bytes_per_tile, 5 * 24 + 12);
  EXPECT_EQ(summary.descriptor_bytes_per_tile, 5 * 24);
  EXPECT_EQ(summary.chip_bytes_per_tile, 12);
  EXPECT_EQ(summary.extensions,
            (std::vector<std::string>{"gpkg_rtree_index", "gpkg_schema", "pilotage_chips", "pilotage_descriptors"}));
}

TEST(InspectMap, JsonHasTheSameNumbers) {
  const testing::TemporaryFolder folder;
  testing::SmallMap map = testing::make_small_map();
  map.descriptors.clear();
  map.chips.clear();
  map.header.chips = false;
  testing::write_map(folder / "map.gpkg", map);
  const auto json = to_json(inspect_map(folder / "map.gpkg"));
  EXPECT_EQ(json.at("schema_version"), 1);
  EXPECT_EQ(json.at("crs").at("authority"), "EPSG:32750");
  EXPECT_TRUE(json.at("bytes_per_tile").is_null());
  EXPECT_TRUE(json.at("chip_bytes_per_tile").is_null());
  EXPECT_TRUE(json.at("levels").at(0).at("min_agl_m").is_null());
  EXPECT_EQ(json.at("levels").at(1).at("gsd_m"), 1);
  EXPECT_EQ(json.at("tile_columns").at(0).at("name"), "gray_variance");
  EXPECT_EQ(json.at("map_info").at("note"), "höhe über grund");
  EXPECT_THROW(inspect_map(folder / "none.gpkg"), DataError);
}

}  // namespace
}  // namespace pilotage
