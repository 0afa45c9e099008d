#include "pilotage/match/place_ranking.h"

#include <cmath>

#include "match/flown_frame.h"
#include "match/placed_scene.h"
#include <gtest/gtest.h>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/match/landmark_matching.h"
#include "pilotage/match/match_confidence.h"

namespace pilotage {
namespace {

using testing::FlownFrame;
using testing::make_placed_scene;

TEST(ChipComparisonTest, APlacementIsTheSamePlaceAsItsChipMatch) {
  ChipComparison chips;
  chips.pivot_from_nadir_px = {12, -7};
  chips.reference_px = {1000, 2000};
  const Placement placement{{40, -30}, 0.2, 1.03};
  const ChipMatch match = chips.match_at(placement);
  EXPECT_TRUE(match.found);
  EXPECT_NEAR(match.yaw_deg, 0.2 / kRadPerDeg, 1e-12);
  // The nadir lies where the placement puts the point that is the nadir of the frame.
  EXPECT_LT((match.nadir_px - chips.reference_px - placement.map_from_frame({-12, 7})).norm(), 1e-12);
  const Placement again = chips.placement(match);
  EXPECT_LT((again.center_px - placement.center_px).norm(), 1e-12);
  EXPECT_NEAR(again.yaw_rad, placement.yaw_rad, 1e-15);
  EXPECT_EQ(again.scale, placement.scale);
}

TEST(RankPlaces, TheTruePlaceIsBest) {
  const auto scene = make_placed_scene({{210, 190}, 0.01, 1.01});
  const auto places = rank_places(scene.frame, scene.map, scene.space, std::nullopt, std::nullopt, 0.5);
  ASSERT_TRUE(places.has_value());
  const RankedPlace& best = places->best;
  EXPECT_LT((best.match.placement.center_px - scene.truth.center_px).norm(), 1);
  EXPECT_LT(testing::angle_between(best.match.placement.yaw_rad, scene.truth.yaw_rad), 0.01);
  EXPECT_EQ(best.evidence, place_evidence({best.match.evidence(), best.match.expected,
                                           descriptor_of(scene.map.features), scene.map.features_per_mpx, 0, 0}));
  EXPECT_GT(best.evidence, 20);
  EXPECT_LT(places->rival_evidence, best.evidence / 2);
  EXPECT_EQ(best.compared_px, 0) << "no chips were given";
  EXPECT_EQ(places->rival_ncc, 0);
}

TEST(RankPlaces, NothingWithoutVotes) {
  auto scene = make_placed_scene({{210, 190}, 0, 1});
  scene.space.center_px = {9000, 9000};  // no feature is near
  EXPECT_FALSE(rank_places(scene.frame, scene.map, scene.space, std::nullopt, std::nullopt, 0.5).has_value());
}

TEST(RankPlaces, APlaceWithinTheLeastDistanceIsNoRival) {
  const auto scene = make_placed_scene({{210, 190}, 0, 1});
  const auto near = rank_places(scene.frame, scene.map, scene.space, std::nullopt, std::nullopt, 0.5);
  // At 0.01 m per pixel the 6 m are 600 pixels, more than the window: every other candidate counts as the same place.
  const auto all_one = rank_places(scene.frame, scene.map, scene.space, std::nullopt, std::nullopt, 0.01);
  ASSERT_TRUE(near.has_value());
  ASSERT_TRUE(all_one.has_value());
  EXPECT_EQ(all_one->rival_evidence, 0);
  EXPECT_EQ(all_one->best.evidence, near->best.evidence);
}

/// Ten landmarks on the ground of the scene, each by itself and seen `off_px` to the right of where the features have
/// it.
LandmarkSearch landmarks_of(const testing::PlacedScene& scene, double off_px, double half_side_px) {
  LandmarkSearch search;
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector2d from_pivot(random.uniform(-70, 70), random.uniform(-55, 55));
    NearLandmark near;
    near.map_px = scene.truth.map_from_frame(from_pivot);
    near.height_m = kNaN;
    near.half_side_px = half_side_px;
    near.group = static_cast<std::size_t>(i);
    search.near.push_back(near);
    search.sightings.push_back({0, from_pivot + Eigen::Vector2d(off_px, 0)});
  }
  search.sigma_m = {0.3};
  search.p_detect = {0.8};
  search.tolerance_px = {3};
  search.landmarks_in_px2 = {11.0 / (400 * 400)};
  search.looked_at_px = {Eigen::AlignedBox2d(Eigen::Vector2d(-75, -60), Eigen::Vector2d(75, 60))};
  search.turns_and_scales = turns_and_scales(search, scene.space);
  return search;
}

TEST(RankPlaces, FeaturesThatLieOnNoLandmarkAddToWhatLandmarksSay) {
  const auto scene = make_placed_scene({{210, 190}, 0.01, 1.01});
  const auto best_with = [&](double half_side_px) {
    return rank_places(scene.frame, scene.map, scene.space, std::nullopt, landmarks_of(scene, 0, half_side_px), 0.5)
        ->best;
  };
  const RankedPlace apart = best_with(1);
  const RankedPlace covered = best_with(500);
  EXPECT_GE(apart.landmarks.groups, 7U);
  EXPECT_EQ(apart.of_features, covered.of_features);
  const double alone = evidence_of_landmarks(0, landmarks_of(scene, 0, 1), apart.landmarks);
  EXPECT_GT(alone, 5);
  EXPECT_NEAR(covered.evidence, std::max(covered.of_features, alone), 1e-9) << "no feature lies beside a landmark";
  EXPECT_GT(apart.evidence, alone + 0.8 * apart.of_features) << "nearly all do";
  EXPECT_LE(apart.evidence, alone + apart.of_features);
}

TEST(RankPlaces, ThePlaceAsFeaturesHaveItIsKeptBesideThatOfLandmarks) {
  const auto scene = make_placed_scene({{210, 190}, 0.01, 1.01});
  const auto plain = rank_places(scene.frame, scene.map, scene.space, std::nullopt, std::nullopt, 0.5);
  // 10 px are 5 m, no place of its own: features and landmarks cannot both be right.
  const auto places = rank_places(scene.frame, scene.map, scene.space, std::nullopt, landmarks_of(scene, 10, 1), 0.5);
  ASSERT_TRUE(places && places->next_there);
  const auto off_px = [&](const RankedPlace& place) {
    return (place.match.placement.center_px - scene.truth.center_px).norm();
  };
  const RankedPlace& of_landmarks = places->best.by_landmarks ? places->best : *places->next_there;
  const RankedPlace& of_features = places->best.by_landmarks ? *places->next_there : places->best;
  EXPECT_NEAR(off_px(of_landmarks), 10, 2);
  EXPECT_LT(off_px(of_features), 1);
  EXPECT_NEAR(of_features.of_features, plain->best.of_features, 1e-9);
  EXPECT_LT(places->rival_evidence, of_features.evidence / 2) << "neither is the other's rival";
}

/// A frame on a map with chips, up to where these are compared.
struct ComparedFrame {
  FlownFrame flown;
  MapReader map = MapReader::open_unverified(flown.path);
  FrameOnGrid rectified = flown.rectify(map);
  PivotedFrame described = describe(rectified, {});
  LocalMap local = flown.local_map(map, rectified, described);
  SearchSpace space = search_space(rectified, local, flown.options);

  std::optional<ChipComparison> compare() {
    return compare_chips(flown.gray, flown.prior, flown.ground.camera, map, flown.options, rectified, described, local);
  }
  std::optional<RankedPlaces> rank(const std::optional<ChipComparison>& chips) const {
    return rank_places(described, local, space, chips, std::nullopt, rectified.gsd_m);
  }
};

TEST(CompareChips, FindsTheFrameAndSpeaksForItsPlace) {
  ComparedFrame frame;
  const auto chips = frame.compare();
  ASSERT_TRUE(chips.has_value());
  ASSERT_TRUE(chips->best.found);
  const Eigen::Vector2d truth_px =
      frame.rectified.grid.px_from_geodetic(frame.flown.place(FlownFrame::kEast_m, FlownFrame::kNorth_m));
  EXPECT_LT((chips->best.nadir_px - truth_px).norm(), 3);

  const auto with = frame.rank(chips);
  const auto without = frame.rank(std::nullopt);
  ASSERT_TRUE(with.has_value());
  ASSERT_TRUE(without.has_value());
  EXPECT_GT(with->best.compared_px, 1000);
  EXPECT_GT(with->best.ncc, 0.5);
  EXPECT_GT(with->best.evidence, without->best.evidence);
}

TEST(NearRival, IsAPlaceNearlyAsGoodWhereChipsDecide) {
  RankedPlace best;
  best.chips_decide = true;
  best.evidence = best.of_features = 9;
  RankedPlace near = best;
  near.evidence = 6.5;
  near.match.placement.center_px = {3.5, 0};
  EXPECT_TRUE(is_near_rival(best, near));
  near.match.placement.center_px = {2.5, 0};
  EXPECT_FALSE(is_near_rival(best, near)) << "the same place";
  near.match.placement.center_px = {3.5, 0};
  near.evidence = 5.9;
  EXPECT_FALSE(is_near_rival(best, near)) << "far behind";
  near.evidence = 6.5;
  best.chips_decide = false;
  EXPECT_FALSE(is_near_rival(best, near)) << "features alone do";
  best.chips_decide = true;
  best.of_features = 5;
  EXPECT_FALSE(is_near_rival(best, near)) << "landmarks decide";
}

TEST(CompareChips, DecideWhereFeaturesSayTooLittle) {
  ComparedFrame frame;
  auto chips = frame.compare();
  ASSERT_TRUE(chips.has_value());
  const auto decide = [&] { return frame.rank(chips)->best.chips_decide; };
  chips->enough_evidence = least_evidence(frame.flown.options.max_false_fix_rate, frame.rectified.half_width_px);
  EXPECT_FALSE(decide());
  chips->enough_evidence = 1e6;
  EXPECT_TRUE(decide());
}

TEST(CompareChips, OnlyWhereWanted) {
  ComparedFrame frame;
  ASSERT_TRUE(frame.compare().has_value());
  frame.flown.options.chips = false;
  EXPECT_FALSE(frame.compare().has_value());
}

}  // namespace
}  // namespace pilotage
