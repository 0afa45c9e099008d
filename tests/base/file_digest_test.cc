#include "pilotage/base/file_digest.h"

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>

#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"

namespace pilotage {
namespace {

std::string read_whole(const char* file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

// Independent values: b2sum --length=256 of GNU coreutils.
TEST(FileDigest, IsBlake2b256) {
  const testing::TemporaryFolder folder;
  write_file(folder / "empty", "", false);
  EXPECT_EQ(file_digest(folder / "empty"), "0e5751c026e543b2e8ab2eb06099daa1d1e5df47778f7787faab45cdf12fe3a8");
  write_file(folder / "abc", "abc", false);
  EXPECT_EQ(file_digest(folder / "abc"), "bddd813c634239723171ef3fee98579b94964e3bb1cb3e427262c8c068d52319");
}

TEST(FileDigest, DoesNotDependOnThePiecesItReads) {
  const testing::TemporaryFolder folder;
  std::string content(std::size_t{5} << 19, 'x');  // two and a half pieces
  write_file(folder / "a", content, false);
  content.back() = 'y';
  write_file(folder / "b", content, false);
  EXPECT_NE(file_digest(folder / "a"), file_digest(folder / "b"));
}

// A file of the kernel tells a size of one page and ends before: what a short read of a failing medium looks like.
TEST(FileDigest, RefusesAFileThatEndsEarly) {
  const char* const file = "/sys/devices/system/cpu/online";
  std::error_code error;
  if (std::filesystem::file_size(file, error) <= read_whole(file).size() || error) GTEST_SKIP() << "no such file here";
  EXPECT_THROW(file_digest(file), DataError);
}

TEST(FileDigest, NamesTheFileThatCannotBeRead) {
  EXPECT_THROW(file_digest("no/such/file"), DataError);
}

}  // namespace
}  // namespace pilotage
