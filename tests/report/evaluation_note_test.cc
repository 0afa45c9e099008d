#include "pilotage/report/evaluation_note.h"

#include <cmath>

#include "report/report_scene.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/text.h"
#include "pilotage/report/page_text.h"
#include "pilotage/report/report.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;

constexpr const char* kEvaluation = R"json({
  "format": "pilotage-evaluation", "format_version": 1, "inputs": ["a.tif", "b.tif"],
  "outcomes": {"correct": 412, "false": 3, "refused": 96, "not_covered": 11},
  "predictors": [
    {"title": "P(correct fix)", "probability": true, "auc": {"value": 0.8123, "low": 0.75, "high": 0.86},
     "brier_skill": {"value": 0.21, "low": null, "high": null},
     "calibration_error": {"value": 0.04, "low": 0.02, "high": 0.06}},
    {"title": "Gray <variance>", "probability": false, "auc": {"value": null, "low": null, "high": null}}]
})json";
constexpr const char* kDiagram = "<svg xmlns=\"http://www.w3.org/2000/svg\"><script>alert(1)</script></svg>";

TEST(EvaluationNote, HasTheTableAndTheDiagramBesideIt) {
  const testing::TemporaryFolder folder;
  write_file(folder / "evaluation.json", kEvaluation, false);
  EXPECT_EQ(read_evaluation_note(folder.path()).diagram_svg, "");
  write_file(folder / "reliability.svg", kDiagram, false);
  for (const auto& path : {folder.path(), folder / "evaluation.json"}) {
    const EvaluationNote note = read_evaluation_note(path);
    EXPECT_EQ(note.file, (folder / "evaluation.json").string());
    EXPECT_EQ(note.source, "a.tif, b.tif");
    EXPECT_EQ(note.outcomes, "412 correct, 3 false, 96 refused, 11 not covered");
    ASSERT_EQ(note.rows.size(), 2U);
    EXPECT_EQ(note.rows[0].auc, "0.812 (0.750 … 0.860)");
    EXPECT_EQ(note.rows[0].brier_skill, "0.210");
    EXPECT_EQ(note.rows[1].auc, "–");
    EXPECT_EQ(note.rows[1].brier_skill, "");
    EXPECT_EQ(note.diagram_svg, kDiagram);
  }
}

TEST(EvaluationNote, StandsOnThePageAsTextAndPicture) {
  const testing::TemporaryFolder folder;
  write_file(folder / "evaluation.json", kEvaluation, false);
  write_file(folder / "reliability.svg", kDiagram, false);
  ReportInput input = testing::report_scene({});
  EXPECT_THAT(report_html(input), ::testing::Not(HasSubstr("evaluation-heading")));
  input.evaluation = read_evaluation_note(folder.path());
  const std::string html = report_html(input);
  EXPECT_NE(html.find("0.812 (0.750 … 0.860)"), std::string::npos);
  EXPECT_NE(html.find("Gray &lt;variance&gt;"), std::string::npos);
  EXPECT_NE(html.find("<img src=\"data:image/svg+xml;base64," + base64(kDiagram)), std::string::npos);
  EXPECT_EQ(html.find("alert(1)"), std::string::npos) << "the diagram is a picture; nothing in it can run";
}

TEST(EvaluationNote, SaysWhatWasFoundAtTilesOfTheSamePlace) {
  const testing::TemporaryFolder folder;
  write_file(folder / "evaluation.json", kEvaluation, false);
  ReportInput input = testing::report_scene({});
  const GroundTile& tile = input.mission.ground.tiles[3];
  const std::string head = "tile_id,center_lon_deg,center_lat_deg,outcome,error_m\n";
  const auto row = [&](double lon_deg, const std::string& rest) {
    return std::to_string(tile.tile_id) + "," + format_number(lon_deg) + "," + format_number(tile.center.lat_deg) +
           "," + rest + "\n";
  };
  write_file(folder / "evaluation.csv",
             head + row(tile.center.lon_deg, "correct,1.25") + row(tile.center.lon_deg + 0.01, "false,9") +
                 row(tile.center.lon_deg, "not_covered,"),
             false);
  input.evaluation = read_evaluation_note(folder.path());
  ASSERT_EQ(input.evaluation->found.size(), 3U);
  EXPECT_EQ(input.evaluation->found[0].error_m, 1.25);
  EXPECT_TRUE(std::isnan(input.evaluation->found[2].error_m));
  EXPECT_THAT(report_html(input), HasSubstr("\"found\":[[3,\"correct\",1.25],[3,\"not_covered\",null]]"))
      << "a tile of that number elsewhere is another one";
  for (const std::string& text :
       {head + row(7, "splendid,1"), head + row(7, "correct,far"), std::string("tile_id\n")}) {
    write_file(folder / "evaluation.csv", text, true);
    EXPECT_THROW(read_evaluation_note(folder.path()), DataError) << text;
  }
}

TEST(EvaluationNote, RefusesOtherFiles) {
  const testing::TemporaryFolder folder;
  EXPECT_THROW(read_evaluation_note(folder.path()), DataError);
  for (const char* text :
       {"{}", "[]", "{\"format\": \"pilotage-report\"}", "{\"format\": \"pilotage-evaluation\"}", "no"}) {
    write_file(folder / "evaluation.json", text, true);
    EXPECT_THROW(read_evaluation_note(folder.path()), DataError) << text;
  }
}

}  // namespace
}  // namespace pilotage
