#include "pilotage/match/guided_matching.h"

#include "match/placed_scene.h"
#include <gtest/gtest.h>

#include "pilotage/match/frame_on_grid.h"

namespace pilotage {
namespace {

using testing::angle_between;
using testing::make_placed_scene;
using testing::PlacedScene;

GuidedMatch look_at(const PlacedScene& scene, const Candidate& candidate) {
  return match_guided(scene.frame, scene.map, scene.space, {&candidate, 1}).front();
}

GuidedMatch best_match(const PlacedScene& scene) {
  GuidedMatch best;
  for (const Candidate& candidate : vote_for_displacements(scene.frame, scene.map, scene.space, 5)) {
    const GuidedMatch match = look_at(scene, candidate);
    if (match.evidence() > best.evidence()) best = match;
  }
  return best;
}

/// Features whose place in the frame, to the nearest point of the grid, has been described: what `expected` counts.
int features_shown(const PlacedScene& scene, const Placement& placement) {
  int shown = 0;
  for (const Feature& feature : scene.map.features.features) {
    const Eigen::Vector2d place =
        placement.frame_from_map({static_cast<double>(feature.x_px), static_cast<double>(feature.y_px)}) +
        scene.frame.pivot_px;
    const Eigen::Vector2d cell = (place - Eigen::Vector2d(0.5, 0.5)) / scene.frame.grid.step_px;
    if (cell.cwiseAbs().maxCoeff() > 1e6) continue;
    shown += scene.frame.grid.at(static_cast<int>(std::round(cell.x())), static_cast<int>(std::round(cell.y()))) >= 0;
  }
  return shown;
}

TEST(MatchGuided, FindsTheFrameToAFractionOfAPixel) {
  for (const Placement& truth :
       {Placement{{210, 200}, 0, 1}, Placement{{203.4, 188.8}, -0.03, 1.05}, Placement{{222.1, 205.3}, 0.03, 0.95}}) {
    const PlacedScene scene = make_placed_scene(truth);
    const GuidedMatch best = best_match(scene);
    EXPECT_LT((best.placement.center_px - truth.center_px).norm(), 0.5);
    EXPECT_NEAR(best.placement.yaw_rad, truth.yaw_rad, 0.5 * kRadPerDeg) << "the prior pulls a little";
    EXPECT_NEAR(best.placement.scale, truth.scale, 0.01);
    EXPECT_GT(best.expected, 40);
    EXPECT_GT(best.supporters, 0.8 * best.expected);
  }
}

TEST(MatchGuided, MendsACandidateThatIsAFewPixelsOff) {
  const Placement truth{{210.4, 199.3}, 0.01, 1.01};
  const PlacedScene scene = make_placed_scene(truth);
  for (const Eigen::Vector2d& off : {Eigen::Vector2d(3, 0), Eigen::Vector2d(-2, 2), Eigen::Vector2d(0, -3)}) {
    const Candidate candidate{{truth.center_px + off, 0, 1}, 5};
    const GuidedMatch match = look_at(scene, candidate);
    EXPECT_LT((match.placement.center_px - truth.center_px).norm(), 0.5);
    EXPECT_EQ(match.votes, 5);
    EXPECT_EQ(match.evidence(), match.supporters + kVoteValue * 5);
  }
}

TEST(MatchGuided, ExpectsTheFeaturesThatTheFrameShows) {
  const PlacedScene scene = make_placed_scene({{210.4, 199.3}, 0.01, 1.01});
  for (const Eigen::Vector2d& center :
       {Eigen::Vector2d(210, 199), Eigen::Vector2d(150, 230), Eigen::Vector2d(20, 20), Eigen::Vector2d(410, 3)}) {
    for (const double scale : {0.8, 1.0, 1.3}) {
      const Candidate candidate{{center, 0.2, scale}, 0};
      const GuidedMatch match = look_at(scene, candidate);
      EXPECT_EQ(match.expected, features_shown(scene, match.placement)) << center.transpose() << " " << scale;
      EXPECT_LE(match.supporters, match.expected);
    }
  }
}

// What was compared for one candidate is remembered for the next.
TEST(MatchGuided, LooksAtEachOfManyCandidatesAsIfItWereAlone) {
  for (const bool hilly : {false, true}) {
    PlacedScene scene = make_placed_scene({{210.4, 199.3}, 0.01, 1.01});
    if (hilly) {
      for (std::size_t i = 0; i < scene.map.features.size(); ++i) {
        scene.map.relief.stretch.push_back(0.97F + 0.01F * static_cast<float>(i % 7));
      }
    }
    std::vector<Candidate> candidates;
    for (const double off_px : {0.0, 1.0, 2.5, -3.0, 25.0, 0.0}) {
      candidates.push_back({{scene.truth.center_px + Eigen::Vector2d(off_px, -off_px), 0.01 * off_px, 1}, off_px});
    }
    const std::vector<GuidedMatch> matches = match_guided(scene.frame, scene.map, scene.space, candidates);
    ASSERT_EQ(matches.size(), candidates.size());
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const GuidedMatch alone = look_at(scene, candidates[i]);
      EXPECT_EQ(matches[i].placement.center_px, alone.placement.center_px);
      EXPECT_EQ(matches[i].placement.yaw_rad, alone.placement.yaw_rad);
      EXPECT_EQ(matches[i].placement.scale, alone.placement.scale);
      EXPECT_EQ(matches[i].expected, alone.expected);
      EXPECT_EQ(matches[i].supporters, alone.supporters);
      EXPECT_EQ(supporting_pairs(scene.frame, scene.map, alone.placement).size(),
                static_cast<std::size_t>(alone.supporters));
    }
  }
}

TEST(MatchGuided, OtherGroundHasFewSupporters) {
  const PlacedScene scene = make_placed_scene({{210.4, 199.3}, 0.01, 1.01});
  const GuidedMatch here = look_at(scene, {scene.truth, 0});
  for (const Eigen::Vector2d& off : {Eigen::Vector2d(40, 0), Eigen::Vector2d(-35, 30), Eigen::Vector2d(12, -50)}) {
    const Candidate candidate{{scene.truth.center_px + off, 0, 1}, 0};
    const GuidedMatch elsewhere = look_at(scene, candidate);
    EXPECT_GT(elsewhere.expected, 40);
    EXPECT_LT(elsewhere.supporters, 0.3 * here.supporters);
  }
}

TEST(MatchGuided, OffTheMapNothingIsExpectedAndTheCandidateStays) {
  const PlacedScene scene = make_placed_scene({{210, 200}, 0, 1});
  const Candidate far{{{5000, -3000}, 0.01, 1.02}, 2};
  const GuidedMatch match = look_at(scene, far);
  EXPECT_EQ(match.expected, 0);
  EXPECT_EQ(match.supporters, 0);
  EXPECT_EQ(match.placement.center_px, far.placement.center_px);
  EXPECT_EQ(match.placement.yaw_rad, 0.01);
  EXPECT_EQ(match.placement.scale, 1.02);
  EXPECT_TRUE(supporting_pairs(scene.frame, scene.map, far.placement).empty());
}

TEST(SupportingPairs, AreTheSupportersToAFractionOfTheGridStep) {
  const PlacedScene scene = make_placed_scene({{210.4, 199.3}, 0.01, 1.01});
  const GuidedMatch match = look_at(scene, {scene.truth, 0});
  const auto pairs = supporting_pairs(scene.frame, scene.map, match.placement);
  ASSERT_EQ(static_cast<int>(pairs.size()), match.supporters);
  double square_px2 = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const GuidedPair& pair = pairs[i];
    const Feature& feature = scene.map.features.features[pair.map_feature];
    EXPECT_EQ(pair.map_px, Eigen::Vector2d(static_cast<double>(feature.x_px), static_cast<double>(feature.y_px)));
    EXPECT_LT(pair.distance, descriptor_of(scene.map.features).support_distance);
    const double residual_px = (pair.map_px - match.placement.map_from_frame(pair.from_pivot_px)).norm();
    EXPECT_NEAR(pair.residual_px, residual_px, 1e-9);
    square_px2 += (pair.map_px - scene.truth.map_from_frame(pair.from_pivot_px)).squaredNorm();
    if (i > 0) {
      EXPECT_GT(pair.map_feature, pairs[i - 1].map_feature);
    }
  }
  // The grid's own rounding to 2 px would alone leave 0.58 px along each axis.
  EXPECT_LT(std::sqrt(square_px2 / static_cast<double>(2 * pairs.size())), 0.4);
}

}  // namespace
}  // namespace pilotage
