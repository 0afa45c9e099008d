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
using ::testing::EndsWith;
using ::testing::HasSubstr;

const std::string kDigest(64, 'a');
const std::string kOther(64, 'b');

FrameFeatures some_features(int count, int seed) {
  FrameFeatures features;
  features.pixel_sigma_px = 1.0 / 3;
  for (int i = 0; i < count; ++i) features.pixels.emplace_back(i + 0.1 * seed, 2.0 / 3 * i);
  if (count > 0) features.descriptors.create(count, 128, CV_8U);
  for (int i = 0; i < 128 * count; ++i) features.descriptors.data[i] = static_cast<std::uint8_t>(i % 251);
  return features;
}

std::filesystem::path only_file(const std::filesystem::path& folder) {
  std::filesystem::path only;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    EXPECT_EQ(only, "");
    only = entry.path();
  }
  return only;
}

TEST(MatchFolder, GivesBackFeatures) {
  const TemporaryFolder temporary;
  MatchFolder folder(temporary / "new" / "folder");
  EXPECT_FALSE(folder.find_features(kDigest));
  for (const int count : {0, 5}) {
    FrameFeatures kept = some_features(count, 1);
    folder.keep_features(kDigest, kept);
    EXPECT_EQ(kept.digest.size(), 64U);
    const auto found = folder.find_features(kDigest);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->digest, kept.digest);
    EXPECT_EQ(found->pixels, kept.pixels);
    EXPECT_EQ(found->pixel_sigma_px, kept.pixel_sigma_px);
    ASSERT_EQ(found->descriptors.rows, count);
    if (count > 0) {
      EXPECT_EQ(cv::norm(found->descriptors, kept.descriptors, cv::NORM_INF), 0);
    }
  }
  EXPECT_FALSE(folder.find_features(kOther));
  EXPECT_EQ(folder.warning(), "");
}

TEST(MatchFolder, GivesBackMatchesOfTheVeryFeatures) {
  const TemporaryFolder temporary;
  MatchFolder folder(temporary.path());
  FrameFeatures first = some_features(4, 1);
  FrameFeatures second = some_features(5, 2);
  folder.keep_features(kDigest, first);
  folder.keep_features(kOther, second);
  EXPECT_FALSE(folder.find_matches(first, second));
  const FeatureMatches matches{{1, 2}, {3, 4}};
  folder.keep_matches(first, second, matches);
  EXPECT_EQ(folder.find_matches(first, second), matches);
  EXPECT_FALSE(folder.find_matches(second, first));
  folder.keep_matches(second, first, {});
  EXPECT_EQ(folder.find_matches(second, first), FeatureMatches{});  // nothing in common is an answer, too
  // The same picture with other features, as another processor may find them: numbers of the old ones say nothing.
  FrameFeatures others = some_features(4, 3);
  folder.keep_features(kDigest, others);
  EXPECT_FALSE(folder.find_matches(others, second));
  EXPECT_EQ(folder.warning(), "");
}

TEST(MatchFolder, WhatIsDamagedOrOfAnotherPictureIsNotThere) {
  const TemporaryFolder temporary;
  FrameFeatures features = some_features(3, 1);
  MatchFolder folder(temporary.path());
  folder.keep_features(kDigest, features);
  const std::filesystem::path file = only_file(temporary.path());
  const std::string whole = read_file(file);
  int unusable = 0;
  for (std::size_t at = 0; at < whole.size(); at += whole.size() / 40) {
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ 1);
    for (const std::string& bytes : {changed, whole.substr(0, at)}) {
      write_file(file, bytes, true);
      EXPECT_FALSE(folder.find_features(kDigest)) << at;
      EXPECT_THAT(folder.warning(), EndsWith("were not used: " + std::to_string(++unusable)));
    }
  }
  write_file(file, whole, true);
  EXPECT_TRUE(folder.find_features(kDigest));
  const std::string twin = kDigest.substr(0, 60) + "bbbb";  // whose file has the same name
  EXPECT_FALSE(folder.find_features(twin));
  std::filesystem::remove(file);
  std::filesystem::create_directory(file);
  EXPECT_FALSE(folder.find_features(kDigest));
}

TEST(MatchFolder, DamagedMatchesAreNotThere) {
  const TemporaryFolder temporary;
  FrameFeatures features = some_features(3, 1);
  MatchFolder folder(temporary / "matches");
  MatchFolder(temporary / "features").keep_features(kDigest, features);
  folder.keep_matches(features, features, {{0, 1}, {2, 2}});
  const std::filesystem::path file = only_file(temporary / "matches");
  write_file(file, read_file(file).substr(9), true);
  EXPECT_FALSE(folder.find_matches(features, features));
  folder.keep_matches(features, features, {{0, 1}, {2, 3}});  // of a feature that is not there
  EXPECT_FALSE(folder.find_matches(features, features));
  EXPECT_THAT(folder.warning(), EndsWith("were not used: 2"));
}

TEST(MatchFolder, AFolderThatCannotBeMadeOrWrittenToIsNamed) {
  const TemporaryFolder temporary;
  write_file(temporary / "file", "", false);
  EXPECT_THAT(error_of<DataError>([&] { MatchFolder(temporary / "file"); }), HasSubstr("file"));
  MatchFolder folder(temporary / "folder");
  write_file(temporary / "folder" / "aa", "in the way", false);
  FrameFeatures features = some_features(1, 1);
  EXPECT_THAT(error_of<DataError>([&] { folder.keep_features(kDigest, features); }), HasSubstr("folder/aa"));
}

}  // namespace
}  // namespace pilotage
