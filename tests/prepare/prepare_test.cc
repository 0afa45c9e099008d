#include "pilotage/prepare/prepare.h"

#include <set>
#include <string>

#include "testing/temporary_folder.h"
#include "tile/small_mission.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;

PrepareRun run_into(const fs::path& folder, bool overwrite = false, int threads = 1) {
  PrepareRun run;
  run.output_folder = folder;
  run.overwrite = overwrite;
  run.threads = threads;
  return run;
}

std::set<std::string> names_in(const fs::path& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

PrepareOptions small_options(const fs::path& folder) {
  PrepareOptions options;
  options.tile = testing::make_small_mission(folder, testing::two_legs());
  options.score.degraded_copies = 1;
  return options;
}

TEST(Prepare, WritesAllFilesAndNothingElse) {
  const testing::TemporaryFolder folder;
  const PrepareResult result = prepare(small_options(folder.path()), run_into(folder / "out"));
  EXPECT_EQ(names_in(folder / "out"), std::set<std::string>(result.files.begin(), result.files.end()));
  EXPECT_EQ(names_in(folder / "out"),
            (std::set<std::string>{"map.gpkg", "plan.json", "report.gpkg", "report.html", "report.json",
                                   "report_classes.qml", "report_classes.tif", "report_classes.tif.aux.xml",
                                   "scores.qml", "scores.tif", "selection.json", "simulation.json", "tiles.csv"}));
  EXPECT_THAT(result.verdict, ::testing::StartsWith("MARGINAL: 92 of 100")) << "one date";
  EXPECT_THAT(result.evidence, ::testing::HasSubstr("of 2000 flights"));
  EXPECT_EQ(result.selected_tiles, result.map.tiles);
  EXPECT_EQ(result.matchable_fraction, 1);
}

// Its own threads, and those of OpenCV, which the command line turns off and a program may not.
TEST(Prepare, SameBytesForAnyNumberOfThreads) {
  const testing::TemporaryFolder folder;
  const PrepareOptions options = small_options(folder.path());
  cv::setNumThreads(1);
  const PrepareResult expected = prepare(options, run_into(folder / "one"));
  cv::setNumThreads(2);
  const PrepareResult result = prepare(options, run_into(folder / "many", false, 3));
  cv::setNumThreads(-1);
  ASSERT_EQ(result.files, expected.files);
  for (const std::string& name : result.files) {
    EXPECT_EQ(read_file(folder / ("many/" + name)), read_file(folder / ("one/" + name))) << name;
  }
}

TEST(Prepare, RefusesExistingOutputsBeforeAnyWork) {
  for (const char* name :
       {"plan.json", "tiles.csv", "scores.tif", "scores_level1.tif", "selection.json", "simulation.json", "map.gpkg",
        "report.html", "report.json", "report.kmz", "report_classes_level2.tif", "scores.qml"}) {
    const testing::TemporaryFolder folder;
    write_file(folder / name, "mine", false);
    PrepareOptions options;
    options.tile.imagery = {"missing.tif"};  // would be refused later
    options.tile.route = "missing.plan";
    try {
      prepare(options, run_into(folder.path()));
      ADD_FAILURE() << name;
    } catch (const DataError& error) {
      EXPECT_THAT(error.what(), ::testing::HasSubstr(std::string(name) + ": exists already"));
    }
    EXPECT_EQ(read_file(folder / name), "mine");
  }
}

TEST(Prepare, WritesOnlyTheOutputsThatAreAskedFor) {
  const testing::TemporaryFolder folder;
  PrepareOptions options = small_options(folder.path());
  options.outputs = {ReportOutput::kKmz};
  prepare(options, run_into(folder / "out"));
  EXPECT_EQ(names_in(folder / "out"), (std::set<std::string>{"map.gpkg", "plan.json", "report.kmz", "scores.tif",
                                                             "selection.json", "simulation.json", "tiles.csv"}));
}

// Interrupted wherever progress is told: nothing is left, and what stood there before is untouched.
TEST(Prepare, LeavesNothingWhenInterruptedAnywhere) {
  const testing::TemporaryFolder folder;
  const PrepareOptions options = small_options(folder.path());
  std::set<std::string> stages;
  prepare(options, run_into(folder / "whole"), [&](std::string_view stage, std::int64_t, std::int64_t) {
    stages.insert(std::string(stage));
    return true;
  });
  EXPECT_GE(stages.size(), 3u);
  for (const std::string& last : stages) {
    const auto stop = [&](std::string_view stage, std::int64_t, std::int64_t) { return stage != last; };
    EXPECT_THROW(prepare(options, run_into(folder / "deep/out", false, 2), stop), Interrupted) << last;
    EXPECT_FALSE(fs::exists(folder / "deep/out")) << last;
    fs::create_directory(folder / "there");
    write_file(folder / "there/map.gpkg", "old", true);
    EXPECT_THROW(prepare(options, run_into(folder / "there", true), stop), Interrupted) << last;
    EXPECT_EQ(names_in(folder / "there"), std::set<std::string>{"map.gpkg"}) << last;
    EXPECT_EQ(read_file(folder / "there/map.gpkg"), "old") << last;
  }
}

TEST(Prepare, OverwritingRemovesRastersOfLevelsThatAreGone) {
  const testing::TemporaryFolder folder;
  write_file(folder / "scores_level1.tif", "of an earlier map", false);
  write_file(folder / "report_classes_level1.tif", "of an earlier map", false);
  write_file(folder / "report.kmz", "of an earlier map", false);
  write_file(folder / "notes.txt", "mine", false);
  prepare(small_options(folder.path()), run_into(folder.path(), true));
  EXPECT_FALSE(fs::exists(folder / "scores_level1.tif"));
  EXPECT_FALSE(fs::exists(folder / "report_classes_level1.tif"));
  EXPECT_FALSE(fs::exists(folder / "report.kmz"));
  EXPECT_EQ(read_file(folder / "notes.txt"), "mine");
}

}  // namespace
}  // namespace pilotage
