#include "pilotage/match/vote_peaks.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include <gtest/gtest.h>

#include "pilotage/base/random.h"

namespace pilotage {
namespace {

/// Every histogram of every turn and scale, whole.
std::vector<Candidate> all_histograms(const std::vector<VotePair>& pairs, const VoteSearch& search, std::size_t count) {
  const int bins = static_cast<int>(2 * search.half_side_px / kVoteBinPx) + 3;
  const Eigen::Vector2d first = search.center_px - Eigen::Vector2d::Constant(search.half_side_px);
  Eigen::Matrix<double, 5, 1> gaussian;
  for (int i = 0; i < 5; ++i) gaussian(i) = std::exp(-(i - 2) * (i - 2) / 2.0);
  gaussian /= gaussian.sum();
  struct Found {
    Candidate candidate;
    std::tuple<double, std::size_t, int, int> order;
  };
  std::vector<Found> found;
  for (std::size_t h = 0; h < search.yaws_rad.size() * search.scales.size(); ++h) {
    const double yaw = search.yaws_rad[h / search.scales.size()];
    const double scale = search.scales[h % search.scales.size()];
    const double c = scale * std::cos(yaw);
    const double s = scale * std::sin(yaw);
    Eigen::MatrixXd histogram = Eigen::MatrixXd::Zero(bins + 8, bins + 8);  // four empty bins all around
    for (const VotePair& pair : pairs) {
      const Eigen::Vector2d& f = pair.from_pivot_px;
      const Eigen::Vector2d at(pair.map_px.x() - (c * f.x() - s * f.y()), pair.map_px.y() - (s * f.x() + c * f.y()));
      const Eigen::Vector2d bin = ((at - first) / kVoteBinPx + Eigen::Vector2d(0.5, 0.5)).array().floor();
      if (bin.minCoeff() < 0 || bin.maxCoeff() >= bins) continue;
      histogram(static_cast<int>(bin.y()) + 4, static_cast<int>(bin.x()) + 4) += pair.weight;
    }
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(bins + 8, bins + 8);
    Eigen::MatrixXd votes = rows;
    for (int y = 0; y < bins + 8; ++y) {
      for (int x = 4; x < bins + 4; ++x) {
        for (int k = 0; k < 5; ++k) rows(y, x) += gaussian(k) * histogram(y, x + k - 2);
        rows(y, x) /= kVoteUnit;
      }
    }
    for (int y = 4; y < bins + 4; ++y) {
      for (int x = 4; x < bins + 4; ++x) {
        for (int k = 0; k < 5; ++k) votes(y, x) += gaussian(k) * rows(y + k - 2, x);
      }
    }
    for (int y = 0; y < bins; ++y) {
      for (int x = 0; x < bins; ++x) {
        const double here = votes(y + 4, x + 4);
        if (here < kMinVotes || here < votes.block<5, 5>(y + 2, x + 2).maxCoeff()) continue;
        found.push_back({{{first + kVoteBinPx * Eigen::Vector2d(x, y), yaw, scale}, here}, {-here, h, y, x}});
      }
    }
  }
  std::sort(found.begin(), found.end(), [](const Found& a, const Found& b) { return a.order < b.order; });
  std::vector<Candidate> kept;
  for (const Found& peak : found) {
    const bool near = std::any_of(kept.begin(), kept.end(), [&](const Candidate& better) {
      return (better.placement.center_px - peak.candidate.placement.center_px).norm() < kPeakSeparationPx;
    });
    if (!near && kept.size() < count) kept.push_back(peak.candidate);
  }
  return kept;
}

std::vector<double> evenly(double middle, double reach, int steps) {
  std::vector<double> values;
  for (int i = -steps; i <= steps; ++i) values.push_back(middle + (steps == 0 ? 0 : reach * i / steps));
  return values;
}

/// Chance pairs all over the square and beyond, and some heaps of pairs that agree about a place.
std::vector<VotePair> random_pairs(Random& random, const VoteSearch& search, int chance, int heaps) {
  const double reach = search.half_side_px + 60;
  const auto anywhere = [&] {
    return Eigen::Vector2d(search.center_px +
                           Eigen::Vector2d(random.uniform(-reach, reach), random.uniform(-reach, reach)));
  };
  const auto frame_point = [&] { return Eigen::Vector2d(random.uniform(-80, 80), random.uniform(-60, 60)); };
  const auto weight = [&] {
    return static_cast<std::int32_t>(random.uniform(0, 1) * random.uniform(0, 1) * kVoteUnit);
  };
  std::vector<VotePair> pairs;
  for (int i = 0; i < chance; ++i) pairs.push_back({frame_point(), anywhere(), weight()});
  for (int heap = 0; heap < heaps; ++heap) {
    const Placement placement{anywhere(), random.uniform(-0.05, 0.05), random.uniform(0.95, 1.05)};
    for (int i = 0; i < 5 * (heap + 1); ++i) {
      const Eigen::Vector2d point = frame_point();
      pairs.push_back({point, placement.map_from_frame(point), weight()});
    }
  }
  return pairs;
}

void expect_same(const std::vector<Candidate>& found, const std::vector<Candidate>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].votes, expected[i].votes) << i;
    EXPECT_EQ(found[i].placement.center_px, expected[i].placement.center_px) << i;
    EXPECT_EQ(found[i].placement.yaw_rad, expected[i].placement.yaw_rad) << i;
    EXPECT_EQ(found[i].placement.scale, expected[i].placement.scale) << i;
  }
}

TEST(VotePeaks, AreThoseOfAllHistograms) {
  Random random(seed_from_name("vote peaks"));
  for (const double half_width_px : {3.0, 41.3, 150.0, 400.0}) {
    for (const std::size_t count : {1U, 8U, 30U}) {
      VoteSearch search;
      search.center_px = {random.uniform(-50, 50), random.uniform(-50, 50)};
      search.half_side_px = half_width_px;
      search.yaws_rad = evenly(0, 0.06, 2);
      search.scales = evenly(1, 0.06, 3);
      const int chance = static_cast<int>(half_width_px * half_width_px / 40) + 20;
      const auto pairs = random_pairs(random, search, chance, 6);
      const auto expected = all_histograms(pairs, search, count);
      if (half_width_px > 40) {
        EXPECT_FALSE(expected.empty());
      }
      expect_same(vote_peaks(pairs, search, count), expected);
    }
  }
}

TEST(VotePeaks, AreThoseOfAllHistogramsAllAroundTheCircle) {
  Random random(seed_from_name("vote peaks around the circle"));
  VoteSearch search;
  search.half_side_px = 90;
  for (int i = 0; i < 40; ++i) {
    search.yaws_rad.push_back(std::remainder(2 * std::numbers::pi * i / 40, 2 * std::numbers::pi));
  }
  search.scales = evenly(1, 0.05, 1);
  const auto pairs = random_pairs(random, search, 3000, 5);
  expect_same(vote_peaks(pairs, search, 20), all_histograms(pairs, search, 20));
}

TEST(VotePeaks, AreThoseOfAllHistogramsWhereAllSquaresAreFullOfVotes) {
  Random random(seed_from_name("vote peaks everywhere"));
  for (const double half_width_px : {12.0, 13.0, 33.3, 93.0, 94.0}) {  // 15, 16, 36, 96 and 97 bins
    VoteSearch search;
    search.center_px = {random.uniform(-50, 50), random.uniform(-50, 50)};
    search.half_side_px = half_width_px;
    search.yaws_rad = evenly(0, 0.05, 4);
    search.scales = evenly(1, 0.06, 3);
    const auto pairs = random_pairs(random, search, 4000, 6);
    expect_same(vote_peaks(pairs, search, 30), all_histograms(pairs, search, 30));
  }
}

// A heap between two places with as many votes as itself takes the place of both, so that fewer than were asked for
// are left for a while.
TEST(VotePeaks, EqualAndNeighbouringPeaksAreKeptInOrder) {
  VoteSearch search;
  search.half_side_px = 60;
  search.yaws_rad = {0};
  search.scales = {1};
  std::vector<VotePair> pairs;
  for (int col = 0; col < 12; ++col) {
    for (int row = 0; row < 12; ++row) {
      const Eigen::Vector2d place(-40 + 7.0 * col, -40 + 7.0 * row);
      pairs.push_back({{0, 0}, place, static_cast<std::int32_t>(kVoteUnit)});
      if ((col + row) % 3 == 0) {
        pairs.push_back({{0, 0}, place + Eigen::Vector2d(3.5, 0), static_cast<std::int32_t>(1.1 * kVoteUnit)});
      }
    }
  }
  for (const std::size_t count : {1U, 5U, 40U, 500U}) {
    expect_same(vote_peaks(pairs, search, count), all_histograms(pairs, search, count));
  }
}

TEST(VotePeaks, NothingWithoutPairsOrVotes) {
  VoteSearch search;
  search.half_side_px = 50;
  search.yaws_rad = {0};
  search.scales = {1};
  EXPECT_TRUE(vote_peaks({}, search, 30).empty());
  const VotePair faint{{0, 0}, {0, 0}, 100};
  EXPECT_TRUE(vote_peaks({faint}, search, 30).empty());
}

TEST(VotePeaks, WhatTheCheckpointThrowsEndsIt) {
  Random random(seed_from_name("vote peaks end"));
  VoteSearch search;
  search.half_side_px = 100;
  search.yaws_rad = {0};
  search.scales = {1};
  const auto pairs = random_pairs(random, search, 500, 3);
  int passes = 0;
  vote_peaks(pairs, search, 30, [&] { ++passes; });
  EXPECT_GT(passes, 1);
  for (int before = 0; before < passes; ++before) {
    int left = before;
    EXPECT_THROW(vote_peaks(pairs, search, 30,
                            [&] {
                              if (left-- == 0) throw 7;
                            }),
                 int)
        << before;
  }
}

}  // namespace
}  // namespace pilotage
