#include "pilotage/capture/match_folder.h"

#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/read_file.h"

namespace pilotage {
namespace {

using pilotage::testing::error_of;
using pilotage::testing::TemporaryFolder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::string kDigest(64, 'a');
const std::string kOther(64, 'b');

FramePicture some_picture(int features) {
  FramePicture picture{kDigest, 640, 480, {}, cv::Mat(3, 4, CV_8UC3)};
  for (int i = 0; i < 36; ++i) picture.small.data[i] = static_cast<std::uint8_t>(7 * i);
  picture.features.pixel_sigma_px = 1.0 / 3;
  for (int i = 0; i < features; ++i) picture.features.pixels.emplace_back(i + 0.1, 2.0 / 3 * i);
  if (features > 0) picture.features.descriptors.create(features, 128, CV_8U);
  for (int i = 0; i < 128 * features; ++i) picture.features.descriptors.data[i] = static_cast<std::uint8_t>(i % 251);
  return picture;
}

std::filesystem::path only_file(const std::filesystem::path& folder) {
  std::filesystem::path only;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    EXPECT_EQ(only, "");
    only = entry.path();
  }
  return only;
}

TEST(MatchFolder, GivesBackWhatItKept) {
  const TemporaryFolder temporary;
  MatchFolder folder(temporary / "new" / "folder", "1.0");
  EXPECT_FALSE(folder.find_picture(kDigest));
  for (const int features : {0, 5}) {
    const FramePicture kept = some_picture(features);
    folder.keep_picture(kept);
    const auto found = folder.find_picture(kDigest);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->digest, kDigest);
    EXPECT_EQ(found->width_px, 640);
    EXPECT_EQ(found->height_px, 480);
    EXPECT_EQ(found->features.pixels, kept.features.pixels);
    EXPECT_EQ(found->features.pixel_sigma_px, kept.features.pixel_sigma_px);
    ASSERT_EQ(found->features.descriptors.rows, features);
    if (features > 0) {
      EXPECT_EQ(cv::norm(found->features.descriptors, kept.features.descriptors, cv::NORM_INF), 0);
    }
    EXPECT_EQ(cv::norm(found->small, kept.small, cv::NORM_INF), 0);
  }
  EXPECT_FALSE(folder.find_picture(kOther));
  EXPECT_THAT(folder.find_matches(kDigest), IsEmpty());
  const MatchesWith matches{{kOther, {{1, 2}, {3, 4}}}, {std::string(64, 'c'), {}}};
  folder.keep_matches(kDigest, matches);
  EXPECT_EQ(folder.find_matches(kDigest), matches);
  EXPECT_EQ(folder.warning(), "");
}

TEST(MatchFolder, WhatIsDamagedOrOfAnotherVersionIsNotThere) {
  const TemporaryFolder temporary;
  MatchFolder(temporary.path(), "1.0").keep_picture(some_picture(3));
  const std::filesystem::path file = only_file(temporary.path());
  const std::string whole = read_file(file);
  int unusable = 0;
  MatchFolder folder(temporary.path(), "1.0");
  for (std::size_t at = 0; at < whole.size(); at += whole.size() / 40) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    for (const std::string& bytes : {changed, whole.substr(0, at)}) {
      write_file(file, bytes, true);
      EXPECT_FALSE(folder.find_picture(kDigest)) << at;
      EXPECT_THAT(folder.warning(), HasSubstr("damaged or of another version of the program, and were made anew: " +
                                              std::to_string(++unusable)));
    }
  }
  write_file(file, whole, true);
  EXPECT_TRUE(folder.find_picture(kDigest));
  MatchFolder later(temporary.path(), "1.1");
  EXPECT_FALSE(later.find_picture(kDigest));
  later.keep_picture(some_picture(3));
  EXPECT_TRUE(later.find_picture(kDigest));
}

TEST(MatchFolder, AFolderThatCannotBeMadeIsNamed) {
  const TemporaryFolder temporary;
  write_file(temporary / "file", "", false);
  EXPECT_THAT(error_of<DataError>([&] { MatchFolder(temporary / "file", "1.0"); }), HasSubstr("file"));
}

}  // namespace
}  // namespace pilotage
