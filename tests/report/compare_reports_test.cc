#include "pilotage/report/compare_reports.h"

#include "report/report_scene.h"
#include "testing/error_of.h"
#include "testing/json_schema.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/report/report_file.h"

namespace pilotage {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

ReportInput scene_with_p() {
  testing::ReportSceneOptions options;
  options.matchable_from = 0.3;
  options.matchable_to = 0.5;
  options.tiles_along = 12;
  ReportInput input = testing::report_scene(options);
  for (TileScores& score : input.scores) {
    if (score.status == TileStatus::kScored) score.p_correct_fix = 0.75;
  }
  return input;
}

/// Both as their report.json tell them.
ReportComparison compared(const ReportInput& a, const ReportInput& b) {
  return compare_reports(report_from_json(report_json(a), "a.json"), report_from_json(report_json(b), "b.json"),
                         {"a.json", "b.json"});
}

std::string reading_error(const nlohmann::ordered_json& json) {
  return testing::error_of<DataError>([&] { report_from_json(json, "a.json"); });
}

TEST(CompareReports, AReportDiffersInNothingFromItself) {
  const ReportComparison comparison = compared(scene_with_p(), scene_with_p());
  EXPECT_TRUE(comparison.same);
  EXPECT_TRUE(comparison.notes.empty());
  EXPECT_EQ(comparison.kept_areas, static_cast<std::int64_t>(scene_with_p().selection.tile_ids.size()));
  EXPECT_EQ(comparison.common_legs, 4);
  EXPECT_THAT(report_comparison_text(comparison), HasSubstr("nothing differs\n"));
  EXPECT_EQ(testing::schema_violation("report-comparison.schema.json", report_comparison_json(comparison)), "");
}

TEST(CompareReports, FindsWhatChanged) {
  const ReportInput before = scene_with_p();
  ReportInput after = scene_with_p();
  std::vector<std::int64_t>& ids = after.selection.tile_ids;
  ASSERT_GT(ids.size(), 4u);
  const std::int64_t dropped = ids[1];
  const std::int64_t changed = ids[2];
  std::int64_t gained = 0;  // a tile that was left out
  while (std::count(ids.begin(), ids.end(), gained) > 0) ++gained;
  ids.erase(ids.begin() + 1);
  ids.push_back(gained);
  std::sort(ids.begin(), ids.end());
  for (std::size_t i = 0; i < after.scores.size(); ++i) {
    const std::int64_t id = after.mission.ground.tiles[i].tile_id;
    if (id == changed) after.scores[i].p_correct_fix = 0.5;
    if (id == ids.back()) after.scores[i].p_correct_fix = 0.755;  // less than what counts
  }
  after.selection.legs[2].max_error_m = 49;
  after.selection.estimated_bytes += 1000;
  after.parameters["camera"]["hfov_deg"] = 60;
  after.parameters["new"] = true;
  after.inputs[0].digest = "blake2b-256:99";
  after.inputs.push_back({"imagery", "second.tif", "", ""});

  const ReportComparison c = compared(before, after);
  EXPECT_FALSE(c.same);
  ASSERT_EQ(c.removed.size(), 1u);
  EXPECT_EQ(c.removed[0].tile_ids[0], dropped);
  EXPECT_EQ(c.removed[0].tile_ids[1], dropped);  // it is still a tile of the plan
  ASSERT_EQ(c.added.size(), 1u);
  EXPECT_EQ(c.added[0].tile_ids[1], gained);
  ASSERT_EQ(c.changed.size(), 1u);
  EXPECT_EQ(c.changed[0].tile_ids[1], changed);
  EXPECT_THAT(c.changed[0].p_correct_fix, ElementsAre(0.75, 0.5));
  EXPECT_EQ(c.kept_areas, static_cast<std::int64_t>(before.selection.tile_ids.size()) - 1);
  ASSERT_EQ(c.legs.size(), 1u);
  EXPECT_THAT(c.legs[0].legs, ElementsAre(3, 3));
  EXPECT_EQ(c.legs[0].statuses[1], "marginal");
  ASSERT_EQ(c.parameters.size(), 2u);
  EXPECT_EQ(c.parameters[0].name, "camera.hfov_deg");
  EXPECT_EQ(c.parameters[1].name, "new");
  EXPECT_TRUE(c.parameters[1].values[0].is_null());
  ASSERT_EQ(c.inputs.size(), 2u);
  EXPECT_EQ(c.inputs[0].name, "imagery");
  EXPECT_EQ(c.inputs[1].name, "imagery 2");
  const std::string text = report_comparison_text(c);
  EXPECT_THAT(text, HasSubstr("1 added, 1 removed, 1 kept with another P"));
  EXPECT_THAT(text, HasSubstr("camera.hfov_deg: 73.7 → 60"));
  EXPECT_THAT(text, HasSubstr("P 0.75 → 0.50"));
  EXPECT_EQ(testing::schema_violation("report-comparison.schema.json", report_comparison_json(c)), "");
  // The other way round, what was added is removed.
  const ReportComparison back = compared(after, before);
  EXPECT_EQ(back.added.size(), 1u);
  EXPECT_EQ(back.removed[0].tile_ids[0], gained);
}

TEST(CompareReports, PairsTilesOfGridsThatAreShifted) {
  const ReportInput before = scene_with_p();
  ReportInput after = scene_with_p();
  for (GroundTile& tile : after.mission.ground.tiles) {  // a third of a stride to the east, with other numbers
    const double shift_m = tile.bounds.width_m() / 6;
    tile.bounds = {tile.bounds.min_x_m + shift_m, tile.bounds.min_y_m, tile.bounds.max_x_m + shift_m,
                   tile.bounds.max_y_m};
    tile.center = after.geodetic_from_map(tile.bounds.center_m());
    tile.tile_id += 1000;
  }
  for (std::int64_t& id : after.selection.tile_ids) id += 1000;
  const ReportComparison c = compared(before, after);
  EXPECT_EQ(c.kept_areas, static_cast<std::int64_t>(before.selection.tile_ids.size()));
  EXPECT_TRUE(c.added.empty());
  EXPECT_TRUE(c.removed.empty());
  ASSERT_EQ(c.notes.size(), 1u);
  EXPECT_THAT(c.notes[0], HasSubstr("different grids"));
}

TEST(CompareReports, TellsLegsThatOnlyOneRouteHas) {
  ReportInput after = scene_with_p();
  after.mission.flight.route.vertices.back().point.lat_deg += 0.01;
  const ReportComparison c = compared(scene_with_p(), after);
  EXPECT_EQ(c.common_legs, 3);
  EXPECT_THAT(c.legs_of_one[0], ElementsAre(4));
  EXPECT_THAT(c.legs_of_one[1], ElementsAre(4));
  EXPECT_THAT(report_comparison_text(c), HasSubstr("legs of b only: 4\n"));
}

TEST(CompareReports, SaysWhenOnlyOneReportHoldsOptions) {
  ReportInput after = scene_with_p();
  after.parameters = nlohmann::ordered_json::object();
  const ReportComparison c = compared(scene_with_p(), after);
  EXPECT_TRUE(c.parameters.empty());
  EXPECT_THAT(report_comparison_text(c), HasSubstr("note: b.json holds no options"));
}

TEST(ReadReport, GivesBackWhatWasWritten) {
  ReportInput input = scene_with_p();
  input.selection.probability = RouteProbability{0.93, 0.9, 12.5, 0.01, WorstStretch{2, 100, 900, 0.04}, {}};
  const nlohmann::ordered_json written = report_json(input);
  nlohmann::ordered_json again = report_json(report_from_json(written, "a.json"));
  for (const char* key : {"software_version", "title", "verdict", "quality", "selection", "grid", "imagery",
                          "elevation", "inputs", "parameters", "warnings", "notes"}) {
    EXPECT_EQ(again[key], written[key]) << key;
  }
  again["route"]["error_profile"] = written["route"]["error_profile"];  // is not read
  EXPECT_EQ(again["route"].dump(), written["route"].dump());
  const auto& columns = written["tiles"]["columns"];
  for (std::size_t c = 0; c < columns.size(); ++c) {
    if (columns[c] != "selected" && columns[c] != "p_correct_fix" && columns[c] != "center_lon_deg") continue;
    for (std::size_t i = 0; i < written["tiles"]["rows"].size(); ++i) {
      EXPECT_EQ(again["tiles"]["rows"][i][c], written["tiles"]["rows"][i][c]) << columns[c] << " " << i;
    }
  }
}

TEST(ReadReport, SaysWhatIsNoReport) {
  const testing::TemporaryFolder folder;
  write_file(folder / "page.html", "<html>", false);
  EXPECT_THROW(read_report(folder / "page.html"), DataError);
  EXPECT_THROW(read_report(folder / "missing.json"), DataError);
  EXPECT_THAT(reading_error(nlohmann::ordered_json::array()), HasSubstr("a.json: is not a report"));
  EXPECT_THAT(reading_error({{"format", "pilotage-plan"}}), HasSubstr("a.json: is not a report"));
  nlohmann::ordered_json report = report_json(scene_with_p());
  EXPECT_EQ(reading_error(report), "");
  report["format_version"] = 3;
  EXPECT_THAT(reading_error(report),
              HasSubstr("format version 3, this program knows 2; compare with the newer program"));
  report["format_version"] = 0;
  EXPECT_THAT(reading_error(report), HasSubstr("write it again"));
}

TEST(ReadReport, NamesWhatIsMissingOrOfAnotherType) {
  const nlohmann::ordered_json good = report_json(scene_with_p());
  nlohmann::ordered_json bad = good;
  bad["route"].erase("legs");
  EXPECT_EQ(reading_error(bad), "a.json.route.legs is missing");
  bad = good;
  bad["route"]["worst_legs"] = {99};
  EXPECT_THAT(reading_error(bad), HasSubstr("names a leg that is not there: 99"));
  bad = good;
  bad["route"]["legs"][1]["status"] = "fine";
  EXPECT_EQ(reading_error(bad), "a.json.route.legs[1].status is \"fine\", allowed are good, marginal and bad");
  bad = good;
  bad["tiles"]["columns"][0] = "id";
  EXPECT_THAT(reading_error(bad), HasSubstr("lacks tile_id"));
  bad = good;
  bad["tiles"]["rows"][2].erase(0);
  EXPECT_THAT(reading_error(bad), HasSubstr("a.json.tiles.rows[2] has not one entry"));
  bad = good;
  bad["tiles"]["rows"][2][0] = "two";
  EXPECT_THAT(reading_error(bad), HasSubstr("a.json.tiles.rows[2].tile_id is \"two\", expected an integer"));
}

}  // namespace
}  // namespace pilotage
