#include "pilotage/mission/selection_file.h"

#include <cmath>

#include "mission/json_damage.h"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

Selection make_selection() {
  Selection selection;
  selection.tile_ids = {0, 3, 4, std::int64_t{1} << 40};
  selection.gaps = {{1, 100.1, 1e6 / 3, 12.5, 61.25, false, 0.125}, {2, 0, 1, 2, 3, true}};
  selection.legs = {{0, 812.3456789012345, 0.1, 9.5, true, 0.9, 1.0 / 7}, {1, 5, 1.0 / 3, 70, false}};
  selection.error_profile = {{0, 9, true, 0.75, 1}, {10, 9.1, false}};
  selection.probability = RouteProbability{0.875, 0.9, 12.5, 0.002, WorstStretch{1, 100, 2000.5, 0.0625}, {}, 0, 9.5};
  selection.advice = {{1, AdviceSide::kLeft, 45.5, 0.25, 0.96, true}, {2, AdviceSide::kNone, 0, 0.5, 0.5, false}};
  selection.matchable_fraction = 2.0 / 3;
  selection.max_error_m = 50;
  selection.sigma_multiple = 2.5;
  selection.within_limit = false;
  selection.estimated_bytes = 123456789;
  selection.notes = {"a \"note\""};
  selection.left_out = LeftOut{0.25, 1.0 / 16, {1, 7}};
  selection.tries = FixTries{1.0 / 3, 45.5, 0.002};
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
  EXPECT_EQ(read.gaps[0].p_first_excess, 0.125);
  EXPECT_EQ(read.legs[0].p_fix, 1.0 / 7);
  EXPECT_TRUE(std::isnan(read.legs[1].p_within_limit));
  EXPECT_EQ(read.error_profile[0].p_correct_fix, 0.75);
  ASSERT_TRUE(read.probability && read.probability->worst);
  EXPECT_EQ(read.probability->worst->to_distance_m, 2000.5);
  EXPECT_EQ(read.probability->level_age_months, 9.5);
  EXPECT_EQ(read.advice[0].side, AdviceSide::kLeft);
  ASSERT_TRUE(read.tries);
  EXPECT_EQ(read.tries->interval_s, 1.0 / 3);
  EXPECT_EQ(read.tries->decorrelation_m, 45.5);
  ASSERT_TRUE(read.left_out);
  EXPECT_EQ(read.left_out->min_p_correct_fix, 0.25);
  EXPECT_EQ(read.left_out->beyond_budget, (std::vector<std::int64_t>{1, 7}));
}

TEST(SelectionFile, HowItAgesReadsBackExactlyOrIsMissing) {
  Selection selection = make_selection();
  EXPECT_FALSE(selection_from_json(selection_to_json(selection), "selection.json").ageing);
  selection.ageing = RouteAgeing{{{12.5, 0.9, {0.75, 0.95}}, {1.0 / 3 + 18, 0.875, {0.7, 0.9}}}, 21.5, {}};
  auto json = selection_to_json(selection);
  const Selection read = selection_from_json(json, "selection.json");
  EXPECT_EQ(selection_to_json(read).dump(), json.dump());
  EXPECT_EQ(read.ageing->ages[1].age_months, 1.0 / 3 + 18);
  EXPECT_EQ(read.ageing->enough_up_to_months, 21.5);
  EXPECT_FALSE(read.ageing->surely_up_to_months);
  json["ageing"]["ages"][0]["age_months"] = 1e300;
  EXPECT_THROW(selection_from_json(json, "selection.json"), DataError);
  json["ageing"]["ages"].clear();
  EXPECT_THROW(selection_from_json(json, "selection.json"), DataError);
}

TEST(SelectionFile, HowTriesAreMadeMayBeMissing) {
  Selection selection = make_selection();
  selection.tries->decorrelation_m.reset();
  EXPECT_FALSE(selection_from_json(selection_to_json(selection), "selection.json").tries->decorrelation_m);
  selection.tries.reset();
  const auto json = selection_to_json(selection);
  EXPECT_FALSE(json.contains("tries"));
  EXPECT_FALSE(selection_from_json(json, "selection.json").tries);
}

TEST(SelectionFile, NoProbabilityIsNull) {
  Selection selection = make_selection();
  selection.probability.reset();
  const auto json = selection_to_json(selection);
  EXPECT_TRUE(json["probability"].is_null());
  EXPECT_FALSE(selection_from_json(json, "selection.json").probability);
}

TEST(SelectionFile, ASideIsLeftRightOrNone) {
  auto json = selection_to_json(make_selection());
  json["advice"][0]["side"] = "up";
  EXPECT_THROW(selection_from_json(json, "selection.json"), DataError);
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
