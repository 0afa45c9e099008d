#include "pilotage/base/output_file.h"

#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::ptrdiff_t entries(const fs::path& folder) {
  return std::distance(fs::directory_iterator(folder), fs::directory_iterator());
}

TEST(OutputFile, AppearsWhenItIsCommittedAndLeavesNothing) {
  const testing::TemporaryFolder folder;
  {
    OutputFile output(folder / "a.txt", false);
    output.write("a");
    EXPECT_EQ(output.temporary_path().filename(), "a.txt");
    EXPECT_FALSE(fs::exists(folder / "a.txt"));
    output.commit();
  }
  { OutputFile(folder / "b.txt", false).write("b"); }
  EXPECT_EQ(read_file(folder / "a.txt"), "a");
  EXPECT_EQ(entries(folder.path()), 1);
}

// --overwrite as root once meant that /dev/null became a GeoPackage.
TEST(OutputFile, ReplacesNoPipeAndNoLink) {
  const testing::TemporaryFolder folder;
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  write_file(folder / "target", "old", false);
  fs::create_symlink(folder / "target", folder / "link");
  fs::create_symlink(folder / "nowhere", folder / "dangling");
  for (const char* name : {"pipe", "link", "dangling"}) {
    EXPECT_THAT([&] { write_file(folder / name, "new", true); },
                ThrowsMessage<DataError>(HasSubstr("name a regular file")))
        << name;
  }
  EXPECT_TRUE(fs::is_fifo(folder / "pipe"));
  EXPECT_EQ(read_file(folder / "target"), "old");
}

TEST(OutputFile, KeepsTheModeOfWhatItReplaces) {
  const testing::TemporaryFolder folder;
  write_file(folder / "a", "secret", false);
  fs::permissions(folder / "a", fs::perms::owner_read | fs::perms::owner_write);
  write_file(folder / "a", "another secret", true);
  EXPECT_EQ(fs::status(folder / "a").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(OutputFile, OfAPairBothOrNoneAreReplaced) {
  const testing::TemporaryFolder folder;
  write_file(folder / "map", "old", false);
  write_file(folder / "map.minisig", "old", false);
  OutputFile map(folder / "map", true);
  OutputFile signature(folder / "map.minisig", true);
  map.write("new");
  EXPECT_THROW(OutputFile::commit({&map, &signature}, {}), DataError) << "the signature was not written";
  EXPECT_EQ(read_file(folder / "map"), "old");
  EXPECT_EQ(read_file(folder / "map.minisig"), "old");
  OutputFile::commit({&map}, {signature.destination()});
  EXPECT_EQ(read_file(folder / "map"), "new");
  EXPECT_FALSE(fs::exists(folder / "map.minisig")) << "the old signature is not of the new map";
}

}  // namespace
}  // namespace pilotage
