#include "pilotage/mission/selection_file.h"

#include "mission/json_damage.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

Selection make_selection() {
  Selection selection;
  selection.tile_ids = {0, 3, 4, std::int64_t{1} << 40};
  selection.gaps = {{1, 100.1, 1e6 / 3, 12.5, 61.25, false}, {2, 0, 1, 2, 3, true}};
  selection.legs = {{0, 812.3456789012345, 0.1, 9.5, true}, {1, 5, 1.0 / 3, 70, false}};
  selection.error_profile = {{0, 9, true}, {10, 9.1, false}};
  selection.matchable_fraction = 2.0 / 3;
  selection.max_error_m = 50;
  selection.sigma_multiple = 2.5;
  selection.within_limit = false;
  selection.estimated_bytes = 123456789;
  selection.notes = {"a \"note\""};
  return selection;
}

TEST(SelectionFile, ReadsBackExactly) {
  const auto json = selection_to_json(make_selection());
  const Selection read = selection_from_json(json, "selection.json");
  EXPECT_EQ(selection_to_json(read).dump(), json.dump());
  EXPECT_EQ(read.tile_ids, make_selection().tile_ids);
  EXPECT_EQ(read.gaps[0].to_distance_m, 1e6 / 3);
  EXPECT_EQ(read.legs[1].matchable_fraction, 1.0 / 3);
  EXPECT_FALSE(read.gaps[0].within_limit);
  EXPECT_TRUE(read.error_profile[0].matchable);
}

// Whatever key is removed, added or replaced by another type: DataError that names the file.
TEST(SelectionFile, RefusesEveryDamage) {
  testing::expect_every_damage_refused(selection_to_json(make_selection()), [](const auto& json) {
    return selection_to_json(selection_from_json(json, "selection.json"));
  });
}

TEST(SelectionFile, TileIdsAscendAndFitIn63Bits) {
  for (const char* ids : {"[1,1]", "[2,1]", "[-1]", "[1.5]", "[18446744073709551615]", "[\"1\"]", "{}"}) {
    auto json = selection_to_json(make_selection());
    json["tile_ids"] = nlohmann::ordered_json::parse(ids);
    EXPECT_THROW(selection_from_json(json, "selection.json"), DataError) << ids;
  }
}

}  // namespace
}  // namespace pilotage
