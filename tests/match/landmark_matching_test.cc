#include "pilotage/match/landmark_matching.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/match/match_confidence.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;

constexpr double kTolerance_px = 6;

/// A frame of 300 × 300 px whose pivot is its middle and its nadir, and the square that is searched.
PivotedFrame square_frame() {
  PivotedFrame frame;
  frame.pivot_px = frame.nadir_px = {150, 150};
  frame.radius_px = 212;
  return frame;
}

SearchSpace search_square() {
  return {{0, 0}, kCalibratedHalfWidthPx, 0.02, 0.03};
}

/// Landmarks of one class anywhere a frame of the square may see them.
LandmarkSearch random_landmarks(int landmarks, Random& random) {
  LandmarkSearch search;
  const double reach_px = std::numbers::sqrt2 * kCalibratedHalfWidthPx + 212;
  while (std::ssize(search.near) < landmarks) {
    NearLandmark near;
    near.map_px = {random.uniform(-reach_px, reach_px), random.uniform(-reach_px, reach_px)};
    near.height_m = kNaN;
    if (near.map_px.norm() <= reach_px) search.near.push_back(near);
  }
  group_landmarks(0, search.near);  // independent, each by itself
  search.sigma_m = {0.3};
  search.tolerance_px = {kTolerance_px};
  search.landmarks_in_px2 = {(landmarks + 1) / (std::numbers::pi * reach_px * reach_px)};
  return search;
}

/// What a frame shows of the landmarks where it lies so, with an error of one pixel each.
void add_sightings(const PivotedFrame& frame, const Placement& placement, Random& random, LandmarkSearch& search) {
  for (const NearLandmark& near : search.near) {
    const Vector2d at = placement.frame_from_map(near.map_px);
    const Vector2d from_pivot = frame.stretched(at, 1 / near.stretch);
    if (from_pivot.cwiseAbs().maxCoeff() > 150) continue;
    search.sightings.push_back({near.detector, from_pivot + 0.7 * Vector2d(random.normal(), random.normal())});
  }
}

void add_false_alarms(int count, Random& random, LandmarkSearch& search) {
  for (int i = 0; i < count; ++i) {
    search.sightings.push_back({0, {random.uniform(-150, 150), random.uniform(-150, 150)}});
  }
  search.turns_and_scales = turns_and_scales(search, search_square());
}

TEST(LandmarkMatching, APlaceIsFoundAmongFalseAlarmsWithItsTurnAndScale) {
  const PivotedFrame frame = square_frame();
  Random random(5);
  int found = 0;
  int strong = 0;
  for (int trial = 0; trial < 20; ++trial) {
    LandmarkSearch search = random_landmarks(30, random);
    const Placement truth{{random.uniform(-140, 140), random.uniform(-140, 140)},
                          0.02 * random.uniform(-1, 1),
                          1 + 0.03 * random.uniform(-1, 1)};
    add_sightings(frame, truth, random, search);
    const auto shown = search.sightings.size();
    add_false_alarms(3, random, search);
    if (shown < 4) continue;
    const auto places = landmark_places(frame, search, search_square(), 4, kPeakSeparationPx);
    ASSERT_FALSE(places.empty());
    EXPECT_LT((places[0].center_px - truth.center_px).norm(), 2.5);
    EXPECT_NEAR(places[0].yaw_rad, truth.yaw_rad, 0.015);
    EXPECT_NEAR(places[0].scale, truth.scale, 0.02);
    const auto pairs = pair_landmarks(frame, search, places[0]);
    EXPECT_GE(pairs.size(), shown);
    strong += landmark_evidence(search, independent_groups(search, pairs)) > 3 ? 1 : 0;
    ++found;
  }
  EXPECT_GE(found, 8);
  EXPECT_GE(strong, 3);
}

TEST(LandmarkMatching, HigherGroundIsSeenFartherOff) {
  PivotedFrame frame = square_frame();
  frame.nadir_px = {20, 40};
  Random random(6);
  LandmarkSearch search = random_landmarks(60, random);
  for (NearLandmark& near : search.near) near.stretch = random.uniform(0.85, 1.1);
  const Placement truth{{30, -20}, 0.01, 1.01};
  add_sightings(frame, truth, random, search);
  ASSERT_GE(search.sightings.size(), 5U);
  const auto places = landmark_places(frame, search, search_square(), 1, kPeakSeparationPx);
  ASSERT_EQ(places.size(), 1U);
  EXPECT_LT((places[0].center_px - truth.center_px).norm(), 3);
  EXPECT_GE(pair_landmarks(frame, search, truth).size(), search.sightings.size() - 1);
  for (NearLandmark& near : search.near) near.stretch = 1;
  EXPECT_LT(pair_landmarks(frame, search, truth).size(), search.sightings.size() - 2) << "as on level ground";
}

TEST(LandmarkMatching, ClassesAreNotMixedAndNothingIsCountedTwice) {
  const PivotedFrame frame = square_frame();
  LandmarkSearch search;
  search.near = {{0, {10, 0}, kNaN, 1}, {1, {-20, 0}, kNaN, 1}, {1, {12, 1}, kNaN, 1}};
  search.sightings = {{0, {10, 0}}, {0, {11, 0}}, {1, {-20, 0}}, {0, {-20, 1}}};
  search.sigma_m = {0.3, 0.3};
  search.tolerance_px = {3, 3};
  search.landmarks_in_px2 = {1e-5, 1e-5};
  const auto pairs = pair_landmarks(frame, search, {});
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[0].sighting, 0U);
  EXPECT_EQ(pairs[0].near, 0U);
  EXPECT_EQ(pairs[1].sighting, 2U);
  EXPECT_EQ(pairs[1].near, 1U);
}

LandmarkView view_of(std::size_t groups, double against = 0) {
  return {std::vector<LandmarkPair>(groups), groups, groups, against};
}

TEST(LandmarkMatching, WhatIsAgainstAPlaceIsTakenOff) {
  Random random(1);
  LandmarkSearch search = random_landmarks(10, random);
  add_false_alarms(5, random, search);
  const double four = landmark_evidence(search, 4);
  ASSERT_GT(four, 5);
  EXPECT_GT(landmark_evidence(search, 5), four);
  EXPECT_EQ(landmark_evidence(search, 2), 0) << "two make no place";
  EXPECT_DOUBLE_EQ(evidence_of_landmarks(0, search, view_of(4)), four);
  EXPECT_DOUBLE_EQ(evidence_of_landmarks(0, search, view_of(4, 3)), four - 3) << "landmarks that are not seen";
  EXPECT_DOUBLE_EQ(evidence_of_landmarks(4, search, view_of(4)), four - 4) << "chips that contradict";
  EXPECT_EQ(evidence_of_landmarks(4, search, view_of(4, 1000)), 0);
}

TEST(LandmarkMatching, WhatStandsTogetherIsOneGroupOfAnyClass) {
  LandmarkSearch search;
  for (const Vector2d& at : {Vector2d(0, 0), Vector2d(30, 0), Vector2d(60, 10), Vector2d(200, 0), Vector2d(200, 3)}) {
    search.near.push_back({search.near.size() % 2, at});
  }
  group_landmarks(40, search.near);
  std::vector<std::size_t> groups;
  for (const NearLandmark& near : search.near) groups.push_back(near.group);
  EXPECT_EQ(groups, (std::vector<std::size_t>{0, 0, 0, 1, 1})) << "in steps, and two classes on one object";
  search.tolerance_px = {3, 3};
  EXPECT_EQ(independent_groups(search, {{0, 0}, {1, 2}}), 1U);
  EXPECT_EQ(independent_groups(search, {{0, 0}, {1, 2}, {2, 3}, {3, 4}}), 2U);
  EXPECT_EQ(independent_groups(search, {}), 0U);
}

TEST(LandmarkMatching, WhatHangsTogetherWithItsClassOverALongWayIsACrowd) {
  std::vector<NearLandmark> landmarks;
  for (int i = 0; i < 5; ++i) landmarks.push_back({0, {35.0 * i, 0}});  // 140 px: more than three steps of 40
  for (int i = 0; i < 4; ++i) landmarks.push_back({1, {35.0 * i, 10}});
  landmarks.push_back({0, {70, 300}});
  EXPECT_EQ(in_crowds(40, landmarks),
            (std::vector<bool>{true, true, true, true, true, false, false, false, false, false}));
  EXPECT_EQ(in_crowds(40, {}), std::vector<bool>{});
}

TEST(LandmarkMatching, RowsAndGridsSayLittle) {
  const auto groups_of = [](const std::vector<Vector2d>& places_px) {
    LandmarkSearch search;
    std::vector<LandmarkPair> pairs;
    for (const Vector2d& place : places_px) {
      pairs.push_back({pairs.size(), search.near.size()});
      search.near.push_back({0, place});
    }
    search.tolerance_px = {5};
    group_landmarks(50, search.near);
    return independent_groups(search, pairs);
  };
  EXPECT_EQ(groups_of({{0, 0}, {100, 3}, {230, -3}, {420, 2}}), 2U) << "along a line, whatever their distances";
  EXPECT_EQ(groups_of({{0, 0}, {100, 3}, {230, -3}, {420, 2}, {180, 90}}), 3U) << "one beside the line";
  EXPECT_LE(groups_of({{0, 0}, {100, 0}, {0, 100}, {100, 100}, {200, 0}, {200, 100}}), 2U) << "a grid";
  EXPECT_EQ(groups_of({{0, 0}, {110, 40}, {-70, 130}, {190, 220}}), 4U);
}

TEST(LandmarkMatching, LandmarksThatTheFrameShowsAndNobodySawSpeakAgainst) {
  PivotedFrame frame = square_frame();
  frame.grid.step_px = 4;
  frame.grid.columns = frame.grid.rows = 75;
  frame.grid.index.assign(75 * 75, 0);
  LandmarkSearch search;
  const auto add = [&](std::size_t detector, double x_px, double y_px) {
    search.near.push_back({detector, {x_px, y_px}});
    search.near.back().half_side_px = 20;
  };
  add(0, 10, 0);    // seen
  add(1, -60, 30);  // shown
  add(0, 140, 0);   // what its detector looks at leaves the frame
  add(0, 400, 0);   // beside the frame
  add(0, 60, 60);   // shown, but not found on the other date either
  search.near.back().found = false;
  group_landmarks(0, search.near);
  search.sightings = {{0, {10, 0}}};
  search.sigma_m = {0.3, 0.3};
  search.tolerance_px = {3, 3};
  search.landmarks_in_px2 = {1e-5, 1e-5};
  search.p_detect = {0.5, 0.75};
  search.looked_at_px.assign(2, Eigen::AlignedBox2d(Vector2d(-150, -150), Vector2d(150, 150)));
  const LandmarkView view = view_landmarks(frame, search, {});
  EXPECT_EQ(view.pairs.size(), 1U);
  EXPECT_EQ(view.expected, 2U);
  EXPECT_NEAR(view.against, -std::log(1 - 0.5 * 0.75), 1e-12) << "one at least of two groups is not seen";
  search.near[0].group = search.near[1].group;
  EXPECT_EQ(view_landmarks(frame, search, {}).against, 0) << "its group was";
  search.near[0].group = 7;
  search.looked_at_px[1] = Eigen::AlignedBox2d(Vector2d(0, -150), Vector2d(150, 150));
  EXPECT_EQ(view_landmarks(frame, search, {}).expected, 1U) << "its detector did not look there";
  search.looked_at_px[1] = search.looked_at_px[0];
  frame.grid.index.assign(75 * 75, -1);
  EXPECT_EQ(view_landmarks(frame, search, {}).expected, 1U) << "nothing is shown";
  search.near[1].stretch = 2;
  frame.grid.index.assign(75 * 75, 0);
  frame.nadir_px = {150, 290};
  EXPECT_EQ(view_landmarks(frame, search, {}).expected, 2U);
}

TEST(LandmarkMatching, ManyLandmarksTakeNoLongerThanIsMeant) {
  const PivotedFrame frame = square_frame();
  Random random(9);
  LandmarkSearch search = random_landmarks(1'000, random);
  add_false_alarms(64, random, search);
  int asked = 0;
  landmark_places(frame, search, search_square(), 4, kPeakSeparationPx, [&] { ++asked; });
  EXPECT_LT(asked, 500'000) << "each looks at all landmarks once";
  EXPECT_GT(asked, 1000) << "somebody may have a deadline";
}

// What the evidence claims is kept where sightings have nothing to do with the landmarks: its rate is never less than
// that of the best place.
TEST(LandmarkMatchingThorough, ChanceReachesEvidenceNoMoreOftenThanItClaims) {
  const PivotedFrame frame = square_frame();
  Random random(7);
  constexpr int kTrials = 1500;
  for (const auto& [landmarks, sightings] : {std::pair{8, 4}, std::pair{25, 8}, std::pair{80, 6}}) {
    int tenth = 0;
    int hundredth = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      LandmarkSearch search = random_landmarks(landmarks, random);
      add_false_alarms(sightings, random, search);
      double best = 0;
      for (const Placement& place : landmark_places(frame, search, search_square(), 4, kPeakSeparationPx)) {
        best =
            std::max(best, landmark_evidence(search, independent_groups(search, pair_landmarks(frame, search, place))));
      }
      tenth += best >= std::log(10.0) ? 1 : 0;
      hundredth += best >= std::log(100.0) ? 1 : 0;
    }
    EXPECT_LE(tenth, kTrials / 10) << landmarks << " landmarks, " << sightings << " sightings";
    EXPECT_LE(hundredth, kTrials / 100) << landmarks << " landmarks, " << sightings << " sightings";
  }
}

using Layout = std::function<std::vector<Vector2d>(Random&)>;

/// A row of things with one spacing and a little disorder, along the grid.
std::vector<Vector2d> row_px(double least_px, double most_px, double disorder, Random& random) {
  const double step_px = random.uniform(least_px, most_px);
  const double y_px = random.uniform(-80, 80);
  std::vector<Vector2d> places;
  for (double x_px = -470 + random.uniform(0, step_px); x_px < 470; x_px += step_px) {
    places.emplace_back(x_px + disorder * random.uniform(-1, 1), y_px + random.uniform(-2, 2));
  }
  return places;
}

std::vector<Vector2d> grid_px(double least_px, double most_px, Random& random) {
  const Vector2d step_px(random.uniform(least_px, most_px), random.uniform(least_px, most_px));
  const Vector2d first_px(random.uniform(-450, -300), random.uniform(-450, -300));
  std::vector<Vector2d> places;
  for (double x_px = first_px.x(); x_px < 450; x_px += step_px.x()) {
    for (double y_px = first_px.y(); y_px < 450; y_px += step_px.y()) places.emplace_back(x_px, y_px);
  }
  return places;
}

/// Farms of two rows of three tanks.
std::vector<Vector2d> farms_px(int count, Random& random) {
  std::vector<Vector2d> tanks;
  for (int farm = 0; farm < count; ++farm) {
    const Vector2d corner_px(random.uniform(-450, 350), random.uniform(-450, 400));
    const Vector2d step_px(random.uniform(36, 44), random.uniform(36, 44));
    for (int i = 0; i < 6; ++i) tanks.push_back(corner_px + Vector2d(i % 3, i / 3).cwiseProduct(step_px));
  }
  return tanks;
}

// Things that people set out lie on others that people set out: tanks on tanks of other farms, pylons on pylons, street
// corners on street corners. What the evidence claims is kept there, too, where each by itself would break it.
TEST(LandmarkMatchingThorough, WhatIsSetOutReachesEvidenceNoMoreOftenThanItClaims) {
  const PivotedFrame frame = square_frame();
  constexpr double kLinkPx = kLandmarkGroup_m / 0.6;
  constexpr int kTrials = 600;
  const std::vector<std::pair<const char*, Layout>> layouts = {
      {"a farm", [](Random& random) { return farms_px(1, random); }},
      {"four farms", [](Random& random) { return farms_px(4, random); }},
      {"a close row", [](Random& random) { return row_px(101, 130, 0, random); }},
      {"a row", [](Random& random) { return row_px(140, 160, 0, random); }},
      {"a disorderly row", [](Random& random) { return row_px(110, 140, 8, random); }},
      {"a grid", [](Random& random) { return grid_px(110, 140, random); }}};
  Random random(8);
  for (const auto& [name, layout] : layouts) {
    int claimed = 0;
    int by_each = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      LandmarkSearch search = random_landmarks(0, random);
      for (const Vector2d& place : layout(random)) search.near.push_back({0, place});
      group_landmarks(kLinkPx, search.near);
      for (const Vector2d& place : layout(random)) {
        if (place.cwiseAbs().maxCoeff() <= 280) search.sightings.push_back({0, place});
      }
      if (search.sightings.empty()) continue;
      search.landmarks_in_px2[0] *= static_cast<double>(search.near.size() + 1);
      search.turns_and_scales = turns_and_scales(search, search_square());
      double most = 0;
      for (const Placement& place : landmark_places(frame, search, search_square(), 4, kPeakSeparationPx)) {
        most =
            std::max(most, landmark_evidence(search, independent_groups(search, pair_landmarks(frame, search, place))));
      }
      claimed += most >= std::log(100.0) ? 1 : 0;
      std::size_t most_pairs = 0;
      for (const NearLandmark& near : search.near) {
        for (const LandmarkSighting& sighting : search.sightings) {
          const Placement place{near.map_px - sighting.from_pivot_px, 0, 1};
          if (place.center_px.cwiseAbs().maxCoeff() > kCalibratedHalfWidthPx) continue;
          most_pairs = std::max(most_pairs, pair_landmarks(frame, search, place).size());
        }
      }
      by_each += landmark_evidence(search, most_pairs) >= std::log(100.0) ? 1 : 0;
    }
    EXPECT_LE(claimed, kTrials / 100) << name;
    EXPECT_GE(by_each, kTrials / 20) << name << ": a test that sees nothing";
  }
}

}  // namespace
}  // namespace pilotage
