#include "pilotage/capture/tracks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

FrameFeatures some_features(int count) {
  FrameFeatures features;
  for (int i = 0; i < count; ++i) features.pixels.emplace_back(10 * i + 5, 7 * i + 3);
  return features;
}

FramePair pair_of(int first, int second, std::vector<std::array<int, 2>> matches) {
  return {first, second, std::move(matches)};
}

std::vector<std::array<int, 2>> sightings_of(const Track& track) {
  std::vector<std::array<int, 2>> sightings;
  for (const Sighting& one : track) sightings.push_back({one.frame, one.feature});
  return sightings;
}

TEST(JoinTracks, JoinsWhatSharesFeatures) {
  const std::vector<FrameFeatures> features(3, some_features(4));
  const auto tracks = join_tracks({pair_of(0, 1, {{0, 2}, {3, 3}}), pair_of(1, 2, {{2, 1}})}, features, 8);
  ASSERT_EQ(tracks.size(), 2U);
  using Sightings = std::vector<std::array<int, 2>>;
  EXPECT_EQ(sightings_of(tracks[0]), (Sightings{{0, 0}, {1, 2}, {2, 1}}));
  EXPECT_EQ(sightings_of(tracks[1]), (Sightings{{0, 3}, {1, 3}}));
}

TEST(JoinTracks, DropsAPointThatAFrameSeesTwice) {
  const std::vector<FrameFeatures> features(3, some_features(4));
  EXPECT_TRUE(
      join_tracks({pair_of(0, 1, {{0, 2}}), pair_of(1, 2, {{2, 1}}), pair_of(0, 2, {{1, 1}})}, features, 8).empty());
}

TEST(JoinTracks, LeavesOutShortOnesWhereThereAreEnough) {
  const std::vector<FrameFeatures> features(3, some_features(2));
  std::vector<FrameFeatures> crowded = features;
  for (FrameFeatures& frame : crowded) frame.pixels = {{100, 100}, {100, 101}};
  const auto tracks = join_tracks({pair_of(0, 1, {{0, 0}, {1, 1}}), pair_of(1, 2, {{0, 0}})}, crowded, 1);
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_EQ(tracks.front().size(), 3U);
}

TEST(NeighbouringFrames, FramesOfOneLineDoNotHideTheNext) {
  std::vector<Eigen::Vector2d> nadirs_m;
  for (int line = 0; line < 2; ++line) {
    for (int i = 0; i < 40; ++i) nadirs_m.emplace_back(3.5 * i, 50 * line);
  }
  int across = 0;
  for (const auto& [first, second] : neighbouring_frames(nadirs_m)) across += first < 40 && second >= 40 ? 1 : 0;
  EXPECT_GE(across, 80);
}

TEST(TiedParts, TheLargestFirst) {
  const auto parts = tied_parts({pair_of(1, 3, {}), pair_of(3, 4, {}), pair_of(0, 5, {})}, 6);
  EXPECT_EQ(parts, (std::vector<std::vector<int>>{{1, 3, 4}, {0, 5}, {2}}));
}

}  // namespace
}  // namespace pilotage
