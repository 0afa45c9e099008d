#include "pilotage/match/displacement_voting.h"

#include <bit>
#include <set>
#include <utility>

#include "match/placed_scene.h"
#include <gtest/gtest.h>

#include "pilotage/match/frame_on_grid.h"

namespace pilotage {
namespace {

using testing::angle_between;
using testing::make_placed_scene;
using testing::PlacedScene;

Eigen::Vector2d place_of(const Feature& feature) {
  return {static_cast<double>(feature.x_px), static_cast<double>(feature.y_px)};
}

TEST(PlacementTest, TurnsClockwiseAndScalesAboutThePivot) {
  const Placement placement{{100, 50}, 90 * kRadPerDeg, 2};
  EXPECT_LT((placement.map_from_frame({0, 0}) - Eigen::Vector2d(100, 50)).norm(), 1e-12);
  EXPECT_LT((placement.map_from_frame({1, 0}) - Eigen::Vector2d(100, 52)).norm(), 1e-12) << "right turns to down";
  EXPECT_LT((placement.map_from_frame({0, 3}) - Eigen::Vector2d(94, 50)).norm(), 1e-12) << "down turns to left";
}

TEST(PlacementTest, ThereAndBackIsTheSame) {
  Random random(seed_from_name("placement"));
  for (int i = 0; i < 200; ++i) {
    const Placement placement{
        {random.uniform(-1e4, 1e4), random.uniform(-1e4, 1e4)}, random.uniform(-4, 4), random.uniform(0.5, 2)};
    const Eigen::Vector2d point(random.uniform(-500, 500), random.uniform(-500, 500));
    const PlacementTransform transform(placement);
    EXPECT_LT((placement.frame_from_map(placement.map_from_frame(point)) - point).norm(), 1e-9);
    EXPECT_EQ(transform.map_from_frame(point), placement.map_from_frame(point));
    EXPECT_EQ(transform.frame_from_map(point), placement.frame_from_map(point));
  }
}

/// The voting spelt out for one turn and scale: every pair of descriptors, one bin after the other, in double.
class VoteOracle {
 public:
  VoteOracle(const PlacedScene& scene, const Placement& turned) : scene_(scene) {
    const double limit = descriptor_of(scene.map.features).vote_distance * 8 * scene.map.features.descriptor_bytes;
    const int bins = static_cast<int>(2 * scene.space.half_width_px / kVoteBinPx) + 3;
    histogram_ = cv::Mat::zeros(bins, bins, CV_64F);
    for (std::size_t i = 0; i < scene.map.features.size(); ++i) {
      const Feature& of_map = scene.map.features.features[i];
      for (const auto& [distance, j] : nearest(i, limit)) {
        const Feature& of_frame = scene.frame.grid.points.features[j];
        const Eigen::Vector2d center =
            place_of(of_map) - turned.map_from_frame(place_of(of_frame) - scene.frame.pivot_px);
        add(center, (1 - distance / limit) * (1 - distance / limit));
      }
    }
  }

  /// Votes smoothed by the Gaussian of five bins, at a centre that lies in the middle of a bin.
  double votes_at(const Eigen::Vector2d& center_px) const {
    const Eigen::Vector2d bin = bin_of(center_px);
    double sum = 0;
    double total = 0;
    for (int dy = -2; dy <= 2; ++dy) {
      for (int dx = -2; dx <= 2; ++dx) {
        const double weight = std::exp(-(dx * dx + dy * dy) / 2.0);
        sum += weight * at(static_cast<int>(bin.x()) + dx, static_cast<int>(bin.y()) + dy);
        total += weight;
      }
    }
    return sum / total;
  }

 private:
  Eigen::Vector2d bin_of(const Eigen::Vector2d& center_px) const {
    const Eigen::Vector2d first = scene_.space.center_px - Eigen::Vector2d::Constant(scene_.space.half_width_px);
    return ((center_px - first) / kVoteBinPx + Eigen::Vector2d(0.5, 0.5)).array().floor();
  }
  void add(const Eigen::Vector2d& center_px, double weight) {
    const Eigen::Vector2d bin = bin_of(center_px);
    if (bin.minCoeff() < 0 || bin.maxCoeff() >= histogram_.cols) return;
    histogram_.at<double>(static_cast<int>(bin.y()), static_cast<int>(bin.x())) += weight;
  }
  /// Nothing outside the square.
  double at(int col, int row) const {
    if (col < 0 || row < 0 || col >= histogram_.cols || row >= histogram_.rows) return 0;
    return histogram_.at<double>(row, col);
  }
  /// The nearest descriptors of the frame among those that may show the feature, nearest first.
  std::vector<std::pair<double, std::size_t>> nearest(std::size_t feature, double limit) const {
    const FeatureSet& points = scene_.frame.grid.points;
    const double turned_px = scene_.frame.radius_px * (2 * scene_.space.yaw_sigma_rad + 2 * scene_.space.scale_sigma);
    const Eigen::Vector2d middle =
        place_of(scene_.map.features.features[feature]) - scene_.space.center_px + scene_.frame.pivot_px;
    std::vector<std::pair<double, std::size_t>> all;
    for (std::size_t j = 0; j < points.size(); ++j) {
      const Eigen::Vector2d off = place_of(points.features[j]) - middle;
      if (off.cwiseAbs().maxCoeff() > scene_.space.half_width_px + turned_px) continue;
      int bits = 0;
      for (int byte = 0; byte < points.descriptor_bytes; ++byte) {
        bits += std::popcount(
            static_cast<unsigned>(points.descriptor(j)[byte] ^ scene_.map.features.descriptor(feature)[byte]));
      }
      if (bits < limit) all.emplace_back(bits, j);
    }
    std::sort(all.begin(), all.end());
    if (all.size() > static_cast<std::size_t>(kVoteNeighbours)) all.resize(kVoteNeighbours);
    return all;
  }

  const PlacedScene& scene_;
  cv::Mat histogram_;
};

TEST(VoteForDisplacements, VotesAreThoseOfEveryPair) {
  for (const DescriptorPattern pattern : {DescriptorPattern::kGround, DescriptorPattern::kBrief}) {
    FeatureOptions options;
    options.pattern = pattern;
    options.descriptor_bits = 128;
    const PlacedScene scene = make_placed_scene({{220.3, 190.7}, 0.02, 1.02}, options);
    const auto candidates = vote_for_displacements(scene.frame, scene.map, scene.space, 6);
    ASSERT_GE(candidates.size(), 3U);
    for (const Candidate& candidate : candidates) {
      const Placement turned{{0, 0}, candidate.placement.yaw_rad, candidate.placement.scale};
      EXPECT_NEAR(candidate.votes, VoteOracle(scene, turned).votes_at(candidate.placement.center_px), 1e-3);
    }
  }
}

TEST(VoteForDisplacements, FindsTheFrameWithinABin) {
  for (const Placement& truth :
       {Placement{{210, 200}, 0, 1}, Placement{{203.4, 188.8}, -0.03, 1.05}, Placement{{222.1, 205.3}, 0.03, 0.95}}) {
    const PlacedScene scene = make_placed_scene(truth);
    const auto candidates = vote_for_displacements(scene.frame, scene.map, scene.space, 5);
    ASSERT_FALSE(candidates.empty());
    EXPECT_LT((candidates.front().placement.center_px - truth.center_px).norm(), 2.5);
    EXPECT_NEAR(candidates.front().placement.yaw_rad, truth.yaw_rad, 0.025);
    EXPECT_NEAR(candidates.front().placement.scale, truth.scale, 0.025);
    EXPECT_GT(candidates.front().votes, 3 * candidates[1].votes);
  }
}

TEST(VoteForDisplacements, CandidatesAreSortedApartAndInsideTheSquare) {
  PlacedScene scene = make_placed_scene({{210, 200}, 0, 1});
  scene.space.half_width_px = 63.7;
  const auto candidates = vote_for_displacements(scene.frame, scene.map, scene.space, 30);
  ASSERT_GT(candidates.size(), 5U);
  ASSERT_LE(candidates.size(), 30U);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Placement& placement = candidates[i].placement;
    EXPECT_LE((placement.center_px - scene.space.center_px).cwiseAbs().maxCoeff(), 63.7 + 2 * kVoteBinPx);
    EXPECT_LE(std::abs(placement.yaw_rad), 2 * scene.space.yaw_sigma_rad + 1e-12);
    EXPECT_LE(std::abs(placement.scale - 1), 2 * scene.space.scale_sigma + 1e-12);
    for (std::size_t j = 0; j < i; ++j) {
      EXPECT_GE(candidates[j].votes, candidates[i].votes);
      EXPECT_GE((candidates[j].placement.center_px - placement.center_px).norm(), kPeakSeparationPx);
    }
  }
}

TEST(VoteForDisplacements, ComparesNoMoreThanIsAllowedAsLongAsTheFrameIsLarge) {
  PivotedFrame frame;
  const auto comparisons = [&](std::size_t points, std::size_t map_features) {
    frame.grid.points.features.resize(points);
    return vote_comparisons(frame, map_features);
  };
  EXPECT_EQ(comparisons(15000, 60000), 9e8);
  EXPECT_EQ(comparisons(15000, 600000), 9e9) << "a small frame needs every feature";
  EXPECT_LE(comparisons(147456, 60000), kVotingComparisons);
  EXPECT_EQ(comparisons(50000, 40000), 2e9);
  EXPECT_EQ(comparisons(50000, 40001), 2.00005e9 / 2);
  EXPECT_EQ(comparisons(0, 1000), 0);
}

TEST(VoteForDisplacements, WithoutFeaturesThereIsNoCandidate) {
  PlacedScene scene = make_placed_scene({{210, 200}, 0, 1});
  const FeatureSet features = scene.map.features;
  scene.map.features.features.clear();
  scene.map.features.descriptors.clear();
  EXPECT_TRUE(vote_for_displacements(scene.frame, scene.map, scene.space, 30).empty());
  scene.map.features = features;
  scene.frame.grid.points.features.clear();
  scene.frame.grid.points.descriptors.clear();
  scene.frame.radius_px = 0;
  EXPECT_TRUE(vote_for_displacements(scene.frame, scene.map, scene.space, 30).empty());
}

TEST(DisplacementVoting, AStrideThinsTheFeaturesThatVote) {
  const PlacedScene scene = make_placed_scene({{210, 200}, 0, 1});
  const std::vector<VotePair> all = vote_pairs(scene.frame, scene.map, scene.space);
  const std::vector<VotePair> third = vote_pairs(scene.frame, scene.map, scene.space, {}, 3);
  std::set<std::pair<double, double>> places;
  for (std::size_t i = 0; i < scene.map.features.size(); i += 3) {
    const Eigen::Vector2d place = place_of(scene.map.features.features[i]);
    places.emplace(place.x(), place.y());
  }
  for (const VotePair& pair : third) EXPECT_EQ(places.count({pair.map_px.x(), pair.map_px.y()}), 1U);
  EXPECT_GT(third.size(), all.size() / 5);
  EXPECT_LT(third.size(), all.size() / 2);
}

}  // namespace
}  // namespace pilotage
