#include "pilotage/vision/hamming.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <thread>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"

namespace pilotage {
namespace {

/// Descriptors near a few centres, so that equal distances are common; positions in a 300 × 200 field.
FeatureSet random_features(Random& random, std::size_t count, int bytes, int noise_bits) {
  FeatureSet set;
  set.descriptor_bytes = bytes;
  for (std::size_t i = 0; i < count; ++i) {
    Feature feature;
    feature.x_px = static_cast<float>(random.below(600)) / 2;
    feature.y_px = static_cast<float>(random.below(400)) / 2;
    set.features.push_back(feature);
    const auto center = static_cast<std::uint8_t>(random.below(4) * 0x55);
    std::vector<std::uint8_t> descriptor(static_cast<std::size_t>(bytes), center);
    for (int bit = 0; bit < noise_bits; ++bit) {
      const std::uint64_t at = random.below(static_cast<std::uint64_t>(bytes) * 8);
      descriptor[at / 8] = static_cast<std::uint8_t>(descriptor[at / 8] ^ 1U << at % 8);
    }
    set.descriptors.insert(set.descriptors.end(), descriptor.begin(), descriptor.end());
  }
  return set;
}

std::uint32_t distance(const FeatureSet& a, std::size_t i, const FeatureSet& b, std::size_t j) {
  int bits = 0;
  for (int byte = 0; byte < a.descriptor_bytes; ++byte) {
    bits += std::popcount(static_cast<unsigned>(a.descriptor(i)[byte] ^ b.descriptor(j)[byte]));
  }
  return static_cast<std::uint32_t>(bits);
}

/// Every pair, sorted: what the search must equal.
HammingMatches brute_force(const FeatureSet& map, const FeatureSet& queries, const std::vector<HammingWindow>& windows,
                           int k) {
  HammingMatches result{k, {}};
  for (std::size_t query = 0; query < queries.size(); ++query) {
    std::vector<HammingMatch> all;
    for (std::size_t i = 0; i < map.size(); ++i) {
      const Feature& f = map.features[i];
      if (!windows.empty()) {
        const HammingWindow& w = windows[query];
        if (!(f.x_px >= w.min_x_px && f.x_px <= w.max_x_px && f.y_px >= w.min_y_px && f.y_px <= w.max_y_px)) continue;
      }
      all.push_back({static_cast<std::uint32_t>(i), distance(queries, query, map, i)});
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const HammingMatch& a, const HammingMatch& b) { return a.distance < b.distance; });
    all.resize(static_cast<std::size_t>(k));
    result.matches.insert(result.matches.end(), all.begin(), all.end());
  }
  return result;
}

/// Of every descriptor there is, so that a new one is searched here too.
std::vector<int> all_lengths_bytes() {
  std::vector<int> lengths;
  for (const int words : kDescriptorWords) lengths.push_back(8 * words);
  return lengths;
}

class HammingPaths : public ::testing::TestWithParam<HammingPath> {
 protected:
  void SetUp() override {
    const auto paths = hamming_paths();
    if (std::find(paths.begin(), paths.end(), GetParam()) == paths.end()) {
      GTEST_SKIP() << "this machine cannot run " << hamming_path_name(GetParam());
    }
  }
};

INSTANTIATE_TEST_SUITE_P(All, HammingPaths,
                         ::testing::Values(HammingPath::kPortable, HammingPath::kAvx2, HammingPath::kAvx512,
                                           HammingPath::kNeon),
                         [](const auto& path) { return std::string(hamming_path_name(path.param)); });

TEST_P(HammingPaths, EqualsBruteForce) {
  Random random(seed_from_name("EqualsBruteForce"));
  for (const int bytes : all_lengths_bytes()) {
    for (const std::size_t count : {0U, 1U, 7U, 8U, 9U, 31U, 32U, 33U, 40U, 100U, 513U, 1100U}) {
      const FeatureSet map = random_features(random, count, bytes, 6);
      const FeatureSet queries = random_features(random, 9, bytes, 6);
      const HammingIndex index(map);
      for (const int k : {1, 2, 3, 8}) {
        const auto matches = index.find_nearest(queries, k, GetParam());
        EXPECT_EQ(matches.matches, brute_force(map, queries, {}, k).matches) << bytes << " " << count << " " << k;
        EXPECT_EQ(matches.k, k);
      }
    }
  }
}

TEST_P(HammingPaths, WindowsEqualBruteForce) {
  Random random(seed_from_name("WindowsEqualBruteForce"));
  const double inf = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const int bytes : all_lengths_bytes()) {
    for (const std::size_t count : {0U, 1U, 20U, 300U, 2500U}) {
      FeatureSet map = random_features(random, count, bytes, 5);
      if (count >= 300) {
        // Positions of a damaged map are searched like others.
        map.features[3].x_px = static_cast<float>(nan);
        map.features[4].y_px = static_cast<float>(nan);
        map.features[5].x_px = static_cast<float>(inf);
        map.features[6].y_px = static_cast<float>(-inf);
      }
      const FeatureSet queries = random_features(random, 40, bytes, 5);
      std::vector<HammingWindow> windows;
      for (std::size_t i = 0; i < queries.size(); ++i) {
        // Edges fall on positions, which belong to the window.
        const double x = static_cast<double>(random.below(600)) / 2;
        const double y = static_cast<double>(random.below(400)) / 2;
        const double half = static_cast<double>(random.below(160)) / 2;
        windows.push_back({x - half, y - half, x + half, y + half});
      }
      windows[0] = {-inf, -inf, inf, inf};
      windows[1] = {10, 10, 9, 20};
      windows[2] = {nan, 0, 300, 200};
      windows[3] = {0, 0, 300, nan};
      windows[4] = {-1e300, -1e300, 1e300, 1e300};
      const HammingIndex index(map);
      for (const int k : {1, 4}) {
        EXPECT_EQ(index.find_nearest(queries, windows, k, GetParam()).matches,
                  brute_force(map, queries, windows, k).matches)
            << bytes << " " << count << " " << k;
      }
    }
  }
}

TEST_P(HammingPaths, FindsAllWithinADistance) {
  Random random(seed_from_name("FindsAllWithinADistance"));
  for (const int bytes : all_lengths_bytes()) {
    for (const std::size_t count : {0U, 20U, 700U}) {
      const FeatureSet map = random_features(random, count, bytes, 20);
      const FeatureSet queries = random_features(random, 20, bytes, 20);
      std::vector<HammingWindow> windows(queries.size(), HammingWindow{20, 40, 250, 180});
      windows[3] = {10, 10, 9, 20};
      constexpr std::uint32_t kBits = 25;
      const auto found = HammingIndex(map).find_within(queries, windows, kBits, GetParam());
      ASSERT_EQ(found.begin.size(), queries.size() + 1);
      const auto all = brute_force(map, queries, windows, static_cast<int>(count));
      for (std::size_t query = 0; query < queries.size(); ++query) {
        std::vector<HammingMatch> expected;
        for (const HammingMatch& match : all.of_query(query)) {
          if (match.found() && match.distance <= kBits) expected.push_back(match);
        }
        const auto matches = found.of_query(query);
        EXPECT_EQ(std::vector<HammingMatch>(matches.begin(), matches.end()), expected) << bytes << " " << query;
      }
    }
  }
}

TEST_P(HammingPaths, NothingFartherThanTheLargestDistance) {
  Random random(seed_from_name("NothingFartherThanTheLargestDistance"));
  for (const int bytes : all_lengths_bytes()) {
    const FeatureSet map = random_features(random, 700, bytes, 20);
    const FeatureSet queries = random_features(random, 20, bytes, 20);
    const double inf = std::numeric_limits<double>::infinity();
    const std::vector<HammingWindow> windows(queries.size(), HammingWindow{-inf, 40, 250, inf});
    for (const std::uint32_t max_distance : {0U, 3U, 12U, 17U, 64U}) {
      HammingMatches expected = brute_force(map, queries, windows, 4);
      for (HammingMatch& match : expected.matches) {
        if (match.found() && match.distance > max_distance) match = {};
      }
      EXPECT_EQ(HammingIndex(map).find_nearest(queries, windows, 4, GetParam(), max_distance).matches, expected.matches)
          << bytes << " " << max_distance;
    }
  }
}

TEST_P(HammingPaths, EqualDistancesComeInTheOrderOfTheIndex) {
  FeatureSet map;
  for (int i = 0; i < 100; ++i) {
    // Later features lie more to the left, so that the sorted layout has them the other way round.
    map.features.push_back({static_cast<float>(100 - i), 0, 0, 0});
    map.descriptors.insert(map.descriptors.end(), static_cast<std::size_t>(map.descriptor_bytes), 0);
  }
  FeatureSet query;
  query.features.resize(1);
  query.descriptors.assign(static_cast<std::size_t>(query.descriptor_bytes), 0xFF);
  const auto matches = HammingIndex(map).find_nearest(query, 5, GetParam());
  for (std::uint32_t i = 0; i < 5; ++i) EXPECT_EQ(matches.matches[i], (HammingMatch{i, 128}));
}

TEST_P(HammingPaths, AllBitsCount) {
  for (const int bytes : all_lengths_bytes()) {
    FeatureSet map;
    map.descriptor_bytes = bytes;
    map.features.resize(1);
    map.descriptors.assign(static_cast<std::size_t>(bytes), 0);
    const HammingIndex index(map);
    for (int bit = 0; bit < bytes * 8; ++bit) {
      FeatureSet query = map;
      query.descriptors[static_cast<std::size_t>(bit / 8)] = static_cast<std::uint8_t>(1U << bit % 8);
      EXPECT_EQ(index.find_nearest(query, 1, GetParam()).matches[0].distance, 1U);
    }
  }
}

TEST(Hamming, TooFewCandidatesAreNotFound) {
  FeatureSet map;
  map.features.resize(2);
  map.descriptors.assign(2 * static_cast<std::size_t>(map.descriptor_bytes), 0);
  const auto matches = HammingIndex(map).find_nearest(map, 3);
  EXPECT_TRUE(matches.of_query(1)[1].found());
  EXPECT_FALSE(matches.of_query(1)[2].found());
}

TEST(Hamming, RefusesWhatDoesNotFit) {
  FeatureSet map;
  map.features.resize(2);
  map.descriptors.assign(2 * static_cast<std::size_t>(map.descriptor_bytes) - 1, 0);
  EXPECT_THROW(HammingIndex{map}, UsageError);
  map.descriptors.assign(2 * static_cast<std::size_t>(map.descriptor_bytes), 0);
  const HammingIndex index(map);
  EXPECT_THROW(index.find_nearest(map, 0), UsageError);
  EXPECT_THROW(index.find_nearest(map, 9), UsageError);
  EXPECT_THROW(index.find_nearest(map, std::vector<HammingWindow>(1), 1), UsageError);
  FeatureSet other;
  other.descriptor_bytes = 32;
  EXPECT_THROW(index.find_nearest(other, 1), UsageError);
  other.descriptor_bytes = 20;
  EXPECT_THROW(HammingIndex{other}, UsageError);
}

TEST(Hamming, PathsStartWithTheOneThatAlwaysRuns) {
  EXPECT_EQ(hamming_paths().front(), HammingPath::kPortable);
  EXPECT_EQ(hamming_paths().back(), best_hamming_path());
}

TEST(Hamming, ThreadsMayShareAnIndex) {
  Random random(seed_from_name("ThreadsMayShareAnIndex"));
  const FeatureSet map = random_features(random, 3000, 32, 20);
  const FeatureSet queries = random_features(random, 50, 32, 20);
  const HammingIndex index(map);
  const auto expected = index.find_nearest(queries, 2).matches;
  std::vector<std::vector<HammingMatch>> results(4);
  {
    std::vector<std::jthread> threads;
    for (auto& result : results) threads.emplace_back([&] { result = index.find_nearest(queries, 2).matches; });
  }
  for (const auto& result : results) EXPECT_EQ(result, expected);
}

}  // namespace
}  // namespace pilotage
