#include "pilotage/compare/match_features.h"

#include <bit>
#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

DescribedImage random_bits(int count, std::uint64_t seed) {
  Random random(seed);
  DescribedImage image;
  image.descriptors.create(count, 16, CV_8U);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 16; ++k)
      image.descriptors.at<std::uint8_t>(i, k) = static_cast<std::uint8_t>(random.below(256));
    image.points_px.emplace_back(random.uniform(0, 500), random.uniform(0, 500));
  }
  return image;
}

TEST(MatchFeatures, NearestAndSecondNearestInOrderOfDistance) {
  const DescribedImage frame = random_bits(60, 1);
  const DescribedImage reference = random_bits(300, 2);
  const std::vector<FeatureMatch> matches = match_by_brute_force(frame, reference);
  ASSERT_EQ(matches.size(), 60U);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (i > 0) {
      EXPECT_LE(matches[i - 1].distance, matches[i].distance);
    }
    int best = 1000;
    int second = 1000;
    for (int r = 0; r < 300; ++r) {
      int bits = 0;
      for (int k = 0; k < 16; ++k) {
        bits += std::popcount(static_cast<unsigned>(frame.descriptors.at<std::uint8_t>(matches[i].frame, k) ^
                                                    reference.descriptors.at<std::uint8_t>(r, k)));
      }
      if (bits < best) {
        second = std::exchange(best, bits);
      } else {
        second = std::min(second, bits);
      }
    }
    EXPECT_EQ(matches[i].distance, best);
    EXPECT_EQ(matches[i].second_distance, second);
  }
}

TEST(MatchFeatures, NothingMatchesNothing) {
  const DescribedImage some = random_bits(5, 3);
  EXPECT_TRUE(match_by_brute_force({}, some).empty());
  EXPECT_TRUE(match_by_brute_force(some, {}).empty());
  EXPECT_TRUE(std::isinf(match_by_brute_force(some, random_bits(1, 4)).front().second_distance));
}

// Forty pairs that follow one similarity, sixty that follow none, and some that the ratio test refuses.
struct Scattered {
  DescribedImage frame;
  DescribedImage reference;
  std::vector<FeatureMatch> matches;
};

Scattered scattered(int good, int wild, int ambiguous) {
  Random random(5);
  Scattered result;
  for (int i = 0; i < good + wild + ambiguous; ++i) {
    const Eigen::Vector2d from(random.uniform(0, 400), random.uniform(0, 400));
    const Eigen::Vector2d turned(1.1 * (from.x() * std::cos(0.2) - from.y() * std::sin(0.2)) + 30,
                                 1.1 * (from.x() * std::sin(0.2) + from.y() * std::cos(0.2)) - 12);
    result.frame.points_px.push_back(from);
    result.reference.points_px.push_back(i < good ? turned
                                                  : Eigen::Vector2d(random.uniform(0, 900), random.uniform(0, 900)));
    result.matches.push_back({i, i, 10, i < good + wild ? 40.0F : 12.0F});
  }
  return result;
}

TEST(MatchFeatures, TheSimilarityThatMostAgreeWith) {
  const Scattered s = scattered(40, 60, 25);
  const SimilarityFit fit = fit_similarity(s.frame, s.reference, s.matches, {0.8, 2}, 1);
  EXPECT_EQ(fit.candidates, 100);
  EXPECT_GE(fit.inliers, 40);
  EXPECT_LE(fit.inliers, 42);
  EXPECT_NEAR(fit.scale(), 1.1, 1e-3);
  const Eigen::Vector2d origin = fit.reference_from_frame_px({0, 0});
  EXPECT_NEAR(origin.x(), 30, 0.5);
  EXPECT_NEAR(origin.y(), -12, 0.5);
  const SimilarityFit again = fit_similarity(s.frame, s.reference, s.matches, {0.8, 2}, 1);
  EXPECT_EQ(again.reference_from_frame, fit.reference_from_frame);
}

TEST(MatchFeatures, NoSimilarityFromFewerThanTwo) {
  const Scattered s = scattered(1, 0, 3);
  const SimilarityFit fit = fit_similarity(s.frame, s.reference, s.matches, {0.8, 2}, 1);
  EXPECT_EQ(fit.candidates, 1);
  EXPECT_EQ(fit.inliers, 0);
}

}  // namespace
}  // namespace pilotage
