#include "pilotage/base/staging_folder.h"

#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

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
    staging.publish({"a.txt", "b.txt"});
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
  EXPECT_THROW(staging.publish({"missing.txt"}), DataError);
}

}  // namespace
}  // namespace pilotage
