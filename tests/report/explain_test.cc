#include "pilotage/report/explain.h"

#include <algorithm>
#include <limits>

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
#include "pilotage/report/report.h"

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::report_with_gap;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

TEST(Explain, ALegInAGapSaysHowItIsJudgedWhyAndWhatToDo) {
  const Report report = report_with_gap(0.03);
  const ReportLeg& leg = report.legs[2];
  ASSERT_EQ(leg.quality, QualityStatus::kBad);
  const std::vector<std::string> lines = explain_leg(report, {}, 3);
  EXPECT_THAT(lines.front(), StartsWith("Leg 3"));
  EXPECT_THAT(lines.front(), HasSubstr(": bad."));
  EXPECT_THAT(lines[1], HasSubstr("m > 50 m"));
  EXPECT_THAT(lines,
              Contains(AllOf(StartsWith("No fix from 1.1 km – 3.2 km, legs 2 to 4: "), HasSubstr("68 m > 50 m"))));
  EXPECT_THAT(lines, Contains(StartsWith("Why: ")));
  EXPECT_THAT(lines, Contains(StartsWith("What to change: ")));
  const std::vector<LegAdvice> advice = {{2, AdviceSide::kRight, 40, 0.5, 0.91, true}};
  EXPECT_EQ(explain_leg(report, advice, 3).back(),
            "What to change: Leg 3 flown 40 m to the right stays within the limit with P = 0.910 instead of 0.500.");
}

TEST(Explain, AGoodLegSaysOnlyWhichTilesAreMissing) {
  const Report report = report_with_gap(0.001);
  ASSERT_EQ(report.legs[2].quality, QualityStatus::kGood);
  const std::vector<std::string> lines = explain_leg(report, {}, 3);
  EXPECT_THAT(lines, Not(Contains(StartsWith("What to change: "))));
  EXPECT_THAT(lines.back(), StartsWith("Not stored: "));
}

TEST(Explain, CountsTheTilesAlongALeg) {
  const Report report = report_with_gap(0.03);
  const ReportLeg& leg = report.legs[0];
  const double to_m = leg.from_distance_m + leg.status.length_m;
  const auto along = [&](const ReportTile& tile) {
    return tile.place.distance_m >= leg.from_distance_m && tile.place.distance_m <= to_m;
  };
  const auto all = std::count_if(report.tiles.begin(), report.tiles.end(), along);
  const auto stored = std::count_if(report.tiles.begin(), report.tiles.end(),
                                    [&](const ReportTile& tile) { return tile.selected && along(tile); });
  EXPECT_THAT(explain_leg(report, {}, 1),
              Contains(HasSubstr(std::to_string(stored) + " of the " + std::to_string(all) + " tiles along it")));
}

TEST(Explain, ATileSaysWhetherItIsStoredAndItsMeasures) {
  const Report report = report_with_gap(0.03);
  for (const bool selected : {true, false}) {
    const auto tile = std::find_if(report.tiles.begin(), report.tiles.end(), [&](const ReportTile& candidate) {
      return candidate.selected == selected && !(selected ? std::string("-") : candidate.reasons).empty();
    });
    ASSERT_NE(tile, report.tiles.end());
    const std::vector<std::string> lines = explain_tile(report, tile->tile.tile_id);
    EXPECT_THAT(lines[0], StartsWith("Tile " + std::to_string(tile->tile.tile_id) + " (level "));
    EXPECT_EQ(lines[1], selected ? "It is stored in the map." : "It is not stored: " + tile->reason);
    if (!selected) {
      EXPECT_THAT(lines, Contains("What speaks against it: " + tile->reasons));
    }
    EXPECT_THAT(lines, Contains(StartsWith("  Imagery coverage: ")));
  }
}

TEST(Explain, RefusesWhatIsNotThere) {
  const Report report = report_with_gap(0.03);
  const auto said = [&](const std::string& what) { return [&, what] { explain(report, {}, what); }; };
  EXPECT_THAT(said("leg 0"), ThrowsMessage<UsageError>(HasSubstr("the route has legs 1 to 4")));
  EXPECT_THAT(said("leg 5"), ThrowsMessage<UsageError>(HasSubstr("the route has legs 1 to 4")));
  EXPECT_THAT(said("tile 999999"), ThrowsMessage<UsageError>(HasSubstr("the plan has no such tile; it has ")));
  for (const char* what : {"", "leg", "leg ", "leg 1.5", "leg -1", "leg x", "tiles 3", "3", "leg 1e99", "leg  1"}) {
    EXPECT_THAT(said(what), ThrowsMessage<UsageError>(HasSubstr("allowed are"))) << what;
  }
  EXPECT_EQ(explain(report, {}, "leg 2"), explain_leg(report, {}, 2));
  EXPECT_EQ(explain(report, {}, "tile " + std::to_string(report.tiles[3].tile.tile_id)),
            explain_tile(report, report.tiles[3].tile.tile_id));
}

}  // namespace
}  // namespace pilotage
