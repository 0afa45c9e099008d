#include "pilotage/base/staging_folder.h"

#include <atomic>
#include <chrono>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "testing/temporary_folder.h"
#include <gtest/gtest.h>
#include <unistd.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using testing::TemporaryFolder;

TEST(StagingFolder, OutputsAppearWhenTheyArePublished) {
  const TemporaryFolder folder;
  write_file(folder / "a.txt", "old", false);
  {
    const StagingFolder staging(folder.path());
    write_file(staging / "a.txt", "new", false);
    write_file(staging / "b.txt", "b", false);
    EXPECT_EQ(read_file(folder / "a.txt"), "old");
    EXPECT_FALSE(fs::exists(folder / "b.txt"));
    staging.publish({"a.txt", "b.txt"}, {});
  }
  EXPECT_EQ(read_file(folder / "a.txt"), "new");
  EXPECT_EQ(read_file(folder / "b.txt"), "b");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 2);
}

TEST(StagingFolder, WithoutPublishingNothingIsLeft) {
  const TemporaryFolder folder;
  {
    const StagingFolder staging(folder / "deep/out");
    write_file(staging / "a.txt", "a", false);
    EXPECT_TRUE(fs::exists(folder / "deep/out"));
  }
  EXPECT_FALSE(fs::exists(folder / "deep/out"));
  fs::create_directory(folder / "there");
  { const StagingFolder staging(folder / "there"); }
  EXPECT_TRUE(fs::exists(folder / "there"));
}

TEST(StagingFolder, SaysWhatCannotBeMade) {
  const TemporaryFolder folder;
  write_file(folder / "file", "x", false);
  EXPECT_THROW(StagingFolder(folder / "file"), DataError);
  const StagingFolder staging(folder.path());
  EXPECT_THROW(staging.publish({"missing.txt"}, {}), DataError);
}

// A rename that fails, or a kill, must not leave a report that speaks of another map.
TEST(StagingFolder, AFailureLeavesTheEarlierOutputsAsTheyWere) {
  const TemporaryFolder folder;
  for (const char* name : {"map.gpkg", "report.html", "scores_level1.tif"}) write_file(folder / name, "old", false);
  const StagingFolder staging(folder.path());
  write_file(staging / "report.html", "new", false);
  const std::vector<std::string> stale = {"map.gpkg", "report.html", "scores_level1.tif"};
  EXPECT_THROW(staging.publish({"report.html", "map.gpkg"}, stale), DataError) << "there is no new map";
  for (const std::string& name : stale) EXPECT_EQ(read_file(folder / name), "old") << name;
  write_file(staging / "map.gpkg", "new", false);
  staging.publish({"report.html", "map.gpkg"}, stale);
  EXPECT_EQ(read_file(folder / "map.gpkg"), "new");
  EXPECT_EQ(read_file(folder / "report.html"), "new");
  EXPECT_FALSE(fs::exists(folder / "scores_level1.tif")) << "what has no successor goes";
}

// Two containers that share a volume have the same process numbers.
TEST(StagingFolder, TwoOfOneProcessNumberDoNotDisturbEachOther) {
  const TemporaryFolder folder;
  const StagingFolder first(folder.path());
  write_file(first / "a.txt", "first", false);
  const StagingFolder second(folder.path());
  write_file(second / "a.txt", "second", false);
  EXPECT_EQ(read_file(first / "a.txt"), "first");
}

TEST(StagingFolder, RemovesWhatADeadRunLeftAndNothingElse) {
  const TemporaryFolder folder;
  std::optional<StagingFolder> alive(folder.path());
  write_file(*alive / "a.txt", "x", false);
  const fs::path living = (*alive / "").parent_path();
  std::string dead = living.filename().string();  // of this machine, and nobody holds its lock
  dead.replace(dead.size() - 6, 6, "dead00");
  const std::string elsewhere = ".pilotage-zzzzzzzz-elsewh";  // of another machine, whose locks may not be seen here
  const std::string long_ago = ".pilotage-zzzzzzzz-longag";
  for (const std::string& name : {dead, elsewhere, long_ago, std::string(".pilotage")}) {
    fs::create_directory(folder / name);
    write_file(folder / name / "plan.json", "half", false);
  }
  fs::last_write_time(folder / long_ago, fs::file_time_type::clock::now() - std::chrono::hours(8 * 24));
  const StagingFolder next(folder.path());
  EXPECT_FALSE(fs::exists(folder / dead));
  EXPECT_FALSE(fs::exists(folder / long_ago));
  EXPECT_TRUE(fs::exists(folder / elsewhere));
  EXPECT_TRUE(fs::exists(folder / ".pilotage"));
  EXPECT_TRUE(fs::exists(*alive / "a.txt"));
}

// A library call that hears nothing must not keep a process from ending cleanly (abandon_work_folders).
TEST(WorkFolderDeathTest, AbandonedFoldersGoThoughAnotherThreadWritesInThem) {
  const TemporaryFolder folder;
  write_file(folder / "a.txt", "old", false);
  const auto abandon = [&] {
    const StagingFolder staging(folder / "new");
    const OutputFile output(folder / "a.txt", true);
    std::thread([&] {
      for (int number = 0;; ++number) std::ofstream(staging / ("part" + std::to_string(number))) << "more";
    }).detach();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    abandon_work_folders();
    ::_exit(7);
  };
  EXPECT_EXIT(abandon(), ::testing::ExitedWithCode(7), "");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
  EXPECT_EQ(read_file(folder / "a.txt"), "old");
}

TEST(WorkFolderDeathTest, OutputsThatMoveAreWaitedFor) {
  const TemporaryFolder folder;
  const auto abandon = [&] {
    StagingFolder staging(folder.path());
    write_file(staging / "a.txt", "new", false);
    std::atomic<bool> moving = false;
    std::thread([&] {
      const MovingOutputs held;
      moving = true;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      fs::rename(staging / "a.txt", folder / "a.txt");
    }).detach();
    while (!moving) std::this_thread::yield();
    abandon_work_folders();
    ::_exit(read_file(folder / "a.txt") == "new" ? 7 : 1);
  };
  EXPECT_EXIT(abandon(), ::testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace pilotage
