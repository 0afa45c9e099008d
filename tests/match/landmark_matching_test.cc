#include "pilotage/match/landmark_matching.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "match/shot.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/match/match_confidence.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;
using testing::match_shot;
using testing::Shot;
using testing::ShotAnswer;
using testing::ShotMap;

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
    EXPECT_GT(landmark_evidence(search, count_groups(search, pairs)), 5);
    ++found;
  }
  EXPECT_GE(found, 8);
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
  EXPECT_EQ(count_groups(search, {{0, 0}, {1, 2}}), 1U);
  EXPECT_EQ(count_groups(search, {{0, 0}, {1, 2}, {2, 3}, {3, 4}}), 2U);
  EXPECT_EQ(count_groups(search, {}), 0U);
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
  search.sightings = {{0, {10, 0}}};
  search.sigma_m = {0.3, 0.3};
  search.tolerance_px = {3, 3};
  search.landmarks_in_px2 = {1e-5, 1e-5};
  search.p_detect = {0.5, 0.75};
  const LandmarkView view = view_landmarks(frame, search, {});
  EXPECT_EQ(view.pairs.size(), 1U);
  EXPECT_EQ(view.expected, 2U);
  EXPECT_DOUBLE_EQ(view.against, std::log(4));
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
  LandmarkSearch search = random_landmarks(2'000, random);
  add_false_alarms(64, random, search);
  int asked = 0;
  landmark_places(frame, search, search_square(), 4, kPeakSeparationPx, [&] { ++asked; });
  EXPECT_LT(asked, 250'000) << "each looks at all landmarks once";
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
        best = std::max(best, landmark_evidence(search, count_groups(search, pair_landmarks(frame, search, place))));
      }
      tenth += best >= std::log(10.0) ? 1 : 0;
      hundredth += best >= std::log(100.0) ? 1 : 0;
    }
    EXPECT_LE(tenth, kTrials / 10) << landmarks << " landmarks, " << sightings << " sightings";
    EXPECT_LE(hundredth, kTrials / 100) << landmarks << " landmarks, " << sightings << " sightings";
  }
}

/// A farm of two rows of three tanks, its rows along the grid.
std::vector<Vector2d> farm_px(const Vector2d& corner_px, Random& random) {
  const Vector2d step(random.uniform(36, 44), random.uniform(36, 44));
  std::vector<Vector2d> tanks;
  for (int i = 0; i < 6; ++i) tanks.push_back(corner_px + Vector2d(i % 3, i / 3).cwiseProduct(step));
  return tanks;
}

// Tanks of a farm stand alike on other farms: each farm says once that a place is right.
TEST(LandmarkMatchingThorough, FarmsOfOtherGroundReachEvidenceNoMoreOftenThanItClaims) {
  const PivotedFrame frame = square_frame();
  constexpr double kLinkPx = kLandmarkGroup_m / 0.6;
  constexpr int kTrials = 1000;
  Random random(8);
  for (const auto& [farms, shown] : {std::pair{1, 1}, std::pair{3, 2}, std::pair{6, 2}}) {
    int hundredth = 0;
    int by_one_each = 0;
    for (int trial = 0; trial < kTrials; ++trial) {
      LandmarkSearch search = random_landmarks(0, random);
      for (int i = 0; i < farms; ++i) {
        for (const Vector2d& tank : farm_px({random.uniform(-350, 270), random.uniform(-350, 270)}, random)) {
          search.near.push_back({0, tank});
        }
      }
      for (int i = 0; i < shown; ++i) {
        for (const Vector2d& tank : farm_px({random.uniform(-140, 50), random.uniform(-140, 90)}, random)) {
          search.sightings.push_back({0, tank});
        }
      }
      search.landmarks_in_px2[0] *= static_cast<double>(search.near.size() + 1);
      search.turns_and_scales = turns_and_scales(search, search_square());
      const auto best = [&] {
        double most = 0;
        for (const Placement& place : landmark_places(frame, search, search_square(), 4, kPeakSeparationPx)) {
          most = std::max(most, landmark_evidence(search, count_groups(search, pair_landmarks(frame, search, place))));
        }
        return most;
      };
      group_landmarks(kLinkPx, search.near);
      hundredth += best() >= std::log(100.0) ? 1 : 0;
      group_landmarks(0, search.near);
      by_one_each += best() >= std::log(100.0) ? 1 : 0;
    }
    EXPECT_LE(hundredth, kTrials / 100) << farms << " farms";
    if (farms == 1) {
      EXPECT_GT(by_one_each, kTrials / 50) << "each tank by itself claims what it does not keep";
    }
  }
}

/// Bright discs of 10 m on texture of which nothing is a feature, each a group by itself.
constexpr double kDisc_m = 10;
constexpr double kApartPx = 2 * (kLandmarkGroup_m + 1);

std::vector<Vector2d> disc_places_px(int side_px, int count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vector2d> places;
  while (std::ssize(places) < count) {
    const Vector2d place(random.uniform(30, side_px - 30), random.uniform(30, side_px - 30));
    const bool beside = std::any_of(places.begin(), places.end(),
                                    [&](const Vector2d& other) { return (other - place).norm() < kApartPx; });
    if (!beside) places.push_back(place);
  }
  return places;
}

cv::Mat with_discs(const cv::Mat& ground, const std::vector<Vector2d>& places_px, double gsd_m, int brighter) {
  cv::Mat gray = ground.clone();
  constexpr int kShift = 8;
  for (const Vector2d& place : places_px) {
    const Vector2d middle = (place - Vector2d(0.5, 0.5)) * (1 << kShift);
    cv::circle(gray, {static_cast<int>(std::lround(middle.x())), static_cast<int>(std::lround(middle.y()))},
               static_cast<int>(std::lround(kDisc_m / 2 / gsd_m * (1 << kShift))), cv::Scalar(128 + brighter),
               cv::FILLED, cv::LINE_AA, kShift);
  }
  return gray;
}

/// The mean of what discs look like less the mean of what ground looks like: a filter that finds them.
LandmarkDetector disc_detector(const cv::Mat& ground, double gsd_m) {
  LandmarkDetector detector;
  detector.class_name = "disc";
  detector.gsd_m = gsd_m;
  detector.window = {28, 4, 1};
  detector.context = 25 * gsd_m / kDisc_m;  // between the middles of the first and the last cell
  detector.shortest_m = detector.longest_m = kDisc_m;
  const int cells = detector.window.filter_cells();
  const int side_px = (cells + 2) * detector.window.cell_px;  // a cell around is not described
  std::vector<double> on(detector.window.filter_size(), 0);
  std::vector<double> off(detector.window.filter_size(), 0);
  Random random(3);
  constexpr int kExamples = 200;
  const auto add = [&](const cv::Mat& gray, std::vector<double>& sum) {
    const FhogCells described(gray, detector.window.cell_px, 0);
    std::size_t i = 0;
    for (int plane = 0; plane < kFhogPlanes; ++plane) {
      for (int row = 0; row < cells; ++row) {
        for (int col = 0; col < cells; ++col) {
          sum[i++] += static_cast<double>(described.row(plane, row)[col]) / kExamples;
        }
      }
    }
  };
  for (int example = 0; example < kExamples; ++example) {
    const cv::Rect crop(static_cast<int>(random.uniform(0, ground.cols - side_px)),
                        static_cast<int>(random.uniform(0, ground.rows - side_px)), side_px, side_px);
    const cv::Mat bare = ground(crop).clone();
    add(bare, off);
    const Vector2d middle =
        Vector2d::Constant(side_px / 2.0) + 1.4 * Vector2d(random.uniform(-1, 1), random.uniform(-1, 1));
    add(with_discs(bare, {middle}, gsd_m, 60), on);
  }
  std::vector<float>& filter = detector.filters.emplace_back();
  double norm2 = 0;
  for (std::size_t i = 0; i + 1 < on.size(); ++i) norm2 += (on[i] - off[i]) * (on[i] - off[i]);
  double threshold = 0;
  for (std::size_t i = 0; i + 1 < on.size(); ++i) {
    const double weight = 2 * (on[i] - off[i]) / norm2;
    filter.push_back(static_cast<float>(weight));
    threshold += weight * (on[i] + off[i]) / 2;
  }
  filter.push_back(static_cast<float>(threshold));  // halfway: ground has −1, discs +1
  return detector;
}

/// Ground with discs, and a map of it that has hardly a feature but the discs as landmarks.
ShotMap disc_map(std::uint64_t seed, std::function<double(const Vector2d&)> height_m = {}) {
  testing::TexturedGround ground = testing::make_textured_ground(6);
  ground.camera = {320, 240, 140, 140, 160, 120};  // 137 m wide from 60 m
  ground.height_m = std::move(height_m);
  const int side_px = static_cast<int>(ground.gray.width_px);
  Raster raster = ground.gray.read({0, 0, side_px, side_px});
  cv::Mat smooth;
  cv::GaussianBlur(raster.pixels, smooth, {0, 0}, 6);
  constexpr double kGsd_m = 0.5;
  const std::vector<Vector2d> places_px = disc_places_px(side_px, 20, seed);
  raster.pixels = with_discs(smooth, places_px, kGsd_m, 60);
  ground.gray = gray_source_from(raster);
  MapDetector detector;
  detector.detector = disc_detector(smooth, kGsd_m);
  detector.detector.threshold = 0.5;  // of discs, which have 1: few false alarms
  detector.p_detect = 0.95;
  detector.false_alarms_per_km2 = 1;
  detector.sigma_m = 0.3;
  ground.landmarks.emplace();
  ground.landmarks->detectors.push_back(detector);
  const CrsTransform transform(ground.crs);
  const LocalFrame enu(ground.center);
  for (const Vector2d& place_px : places_px) {
    MapLandmark landmark;
    landmark.id = std::ssize(ground.landmarks->landmarks);
    landmark.place = *transform.geodetic_from_map(ground.gray.map_from_pixel.map_from_pixel(place_px));
    landmark.length_m = kDisc_m;
    landmark.ground_height_m =
        ground.height_m ? ground.height_m(enu.enu_from_geodetic(landmark.place).head<2>()) : kNaN;
    landmark.found = true;
    ground.landmarks->landmarks.push_back(landmark);
  }
  FeatureOptions hardly_any;
  hardly_any.features_per_mpx = 40;
  return ShotMap(std::move(ground), hardly_any);
}

Shot random_shot(Random& random) {
  Shot shot;
  shot.east_m = random.uniform(-70, 70);
  shot.north_m = random.uniform(-70, 70);
  shot.height_m = 90;
  shot.attitude.yaw_deg = random.uniform(0, 360);
  shot.prior_off_m = {random.uniform(-10, 10), random.uniform(-10, 10)};
  shot.attitude_off = {0.7 * random.normal(), 0.5 * random.normal(), 0.5 * random.normal()};
  shot.height_ratio = 1 + 0.02 * random.normal();
  return shot;
}

MatchOptions by_features_and_landmarks(bool landmarks) {
  MatchOptions options;
  options.chips = false;
  options.landmarks = landmarks;
  return options;
}

/// Fixes of `shots` frames, each held against the truth.
void expect_fixes_by_landmarks(const ShotMap& map, int shots, int least) {
  Random random(11);
  int fixes = 0;
  double nees = 0;
  for (int i = 0; i < shots; ++i) {
    const Shot shot = random_shot(random);
    EXPECT_EQ(match_shot(map, shot, by_features_and_landmarks(false)).result.status, MatchStatus::kTooFewFeatures);
    const ShotAnswer answer = match_shot(map, shot, by_features_and_landmarks(true));
    if (!answer.result.fix) continue;
    ++fixes;
    EXPECT_LT(answer.center_error_m.norm(), 2) << i;
    EXPECT_LT(answer.error_m.norm(), 4) << i;
    EXPECT_GE(answer.result.stats.landmarks_seen, answer.result.stats.landmarks_matched);
    EXPECT_GE(answer.result.stats.landmarks_matched, 3);
    nees += mahalanobis_squared(answer.error_m, answer.result.fix->covariance_en_m2);
  }
  EXPECT_GE(fixes, least);
  EXPECT_LT(nees / fixes, 3) << "2 of honest covariances";
}

TEST(LandmarkMatching, GroundWithoutFeaturesIsFoundByItsLandmarks) {
  expect_fixes_by_landmarks(disc_map(1), 20, 6);
}

TEST(LandmarkMatching, OverReliefToo) {
  const auto hill = [](const Vector2d& m) { return 200 + 0.06 * m.x() + 3 * std::sin(m.y() / 30); };
  expect_fixes_by_landmarks(disc_map(1, hill), 15, 4);
}

TEST(LandmarkMatchingThorough, OtherGroundAndOtherWindowsGiveNoFix) {
  const ShotMap map = disc_map(1);
  ShotMap other = disc_map(2);
  other.path = map.path;  // its frames against the first map
  Random random(12);
  int seen = 0;
  for (int i = 0; i < 60; ++i) {
    const Shot shot = random_shot(random);
    const ShotAnswer elsewhere = match_shot(other, shot, by_features_and_landmarks(true));
    EXPECT_FALSE(elsewhere.result.fix) << i;
    seen += elsewhere.result.stats.landmarks_seen;
    Shot displaced = shot;
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    displaced.prior_off_m = 75 * Vector2d(std::cos(angle), std::sin(angle));
    EXPECT_FALSE(match_shot(map, displaced, by_features_and_landmarks(true)).result.fix) << i;
  }
  EXPECT_GT(seen, 200) << "there was something to be taken for a landmark";
}

TEST(LandmarkMatching, AMapWithLandmarksIsAsGoodByItsFeatures) {
  testing::TexturedGround ground = testing::make_textured_ground();
  const ShotMap without(ground);
  ground.landmarks = disc_map(1).ground.landmarks;
  for (MapLandmark& landmark : ground.landmarks->landmarks)
    landmark.place = without.place(0, 0);  // nothing is seen there
  const ShotMap with(ground);
  const ShotAnswer a = match_shot(without, {});
  const ShotAnswer b = match_shot(with, {});
  ASSERT_TRUE(a.result.fix && b.result.fix);
  EXPECT_EQ(a.result.fix->position.lon_deg, b.result.fix->position.lon_deg);
  EXPECT_EQ(a.result.stats.vote_peak, b.result.stats.vote_peak);
  EXPECT_EQ(a.result.stats.landmarks_seen, 0);
}

}  // namespace
}  // namespace pilotage
