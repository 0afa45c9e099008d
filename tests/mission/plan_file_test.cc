#include "pilotage/mission/plan_file.h"

#include "mission/json_damage.h"
#include "testing/temporary_folder.h"
#include "tile/small_mission.h"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/tile/plan_tiles.h"

namespace pilotage {
namespace {

nlohmann::ordered_json small_plan_json() {
  const testing::TemporaryFolder folder;
  auto json = plan_to_json(plan_tiles(testing::make_small_mission(folder.path(), {{150, 150, 50}, {400, 150, 150}})));
  // A few of each list are enough, and quick.
  for (const char* list : {"tiles", "route_samples"}) {
    while (json[list].size() > 3) json[list].erase(json[list].size() - 1);
  }
  return json;
}

TEST(PlanFile, ReadsBackExactly) {
  const auto json = small_plan_json();
  EXPECT_EQ(plan_to_json(plan_from_json(json, "plan.json")).dump(), json.dump());
}

TEST(PlanFile, AnAutopilotIsAKnownOne) {
  auto json = small_plan_json();
  EXPECT_EQ(plan_from_json(json, "plan.json").flight.autopilot, std::nullopt);
  json["autopilot"] = "arduplane";
  const Mission mission = plan_from_json(json, "plan.json");
  EXPECT_EQ(mission.flight.autopilot, Autopilot::kArduplane);
  EXPECT_EQ(plan_to_json(mission)["autopilot"], "arduplane");
  json["autopilot"] = "betaflight";
  EXPECT_THROW(plan_from_json(json, "plan.json"), DataError);
}

TEST(PlanFile, RefusesEveryDamage) {
  testing::expect_every_damage_refused(
      small_plan_json(), [](const auto& json) { return plan_to_json(plan_from_json(json, "plan.json")); });
}

TEST(PlanFile, RefusesEveryTruncation) {
  const testing::TemporaryFolder folder;
  const std::string text = small_plan_json().dump(1);
  for (std::size_t length = 0; length < text.size(); length += 61) {
    write_file(folder / "plan.json", text.substr(0, length), true);
    EXPECT_THROW(read_plan(folder / "plan.json"), DataError) << length;
  }
  EXPECT_THROW(read_plan(folder / "missing.json"), DataError);
}

TEST(PlanFile, RefusesNewerVersionsAndSizesThatOverflow) {
  auto json = small_plan_json();
  json["pilotage_plan"] = 2;
  EXPECT_THROW(plan_from_json(json, "plan.json"), DataError);
  json = small_plan_json();
  json["levels"][0]["grid_width_px"] = std::int64_t{1} << 31;
  EXPECT_THROW(plan_from_json(json, "plan.json"), DataError);
  json = small_plan_json();
  json["tiles"][0]["column"] = json["tiles"][0]["column"].get<int>() + 1;  // not the cell of its number any more
  EXPECT_THROW(plan_from_json(json, "plan.json"), DataError);
}

}  // namespace
}  // namespace pilotage
