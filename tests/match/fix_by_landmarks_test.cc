// Fixes by landmarks alone, over ground that has hardly a feature.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <vector>

#include "match/shot.h"
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/camera/attitude.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/match/landmark_matching.h"
#include "pilotage/match/match.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;
using testing::match_shot;
using testing::Shot;
using testing::ShotAnswer;
using testing::ShotMap;

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
ShotMap disc_map(std::uint64_t seed, std::function<double(const Vector2d&)> height_m = {}, int tiles = 6) {
  testing::TexturedGround ground = testing::make_textured_ground(tiles);
  ground.camera = {320, 240, 140, 140, 160, 120};  // 137 m wide from 60 m
  ground.height_m = std::move(height_m);
  const int side_px = static_cast<int>(ground.gray.width_px);
  Raster raster = ground.gray.read({0, 0, side_px, side_px});
  cv::Mat smooth;
  cv::GaussianBlur(raster.pixels, smooth, {0, 0}, 6);
  constexpr double kGsd_m = 0.5;
  const std::vector<Vector2d> places_px = disc_places_px(side_px, tiles * tiles * 2 / 3 - 4, seed);
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

MatchOptions by_features_and_landmarks(bool landmarks, bool chips = false) {
  MatchOptions options;
  options.chips = chips;
  options.landmarks = landmarks;
  return options;
}

/// Fixes of `shots` frames, each held against the truth; of features alone `by_features` comes.
void expect_fixes_by_landmarks(const ShotMap& map, int shots, int least,
                               MatchStatus by_features = MatchStatus::kTooFewFeatures) {
  Random random(11);
  int fixes = 0;
  double nees = 0;
  for (int i = 0; i < shots; ++i) {
    const Shot shot = random_shot(random);
    EXPECT_EQ(match_shot(map, shot, by_features_and_landmarks(false)).result.status, by_features);
    const ShotAnswer answer = match_shot(map, shot, by_features_and_landmarks(true));
    if (!answer.result.fix) continue;
    ++fixes;
    EXPECT_LT(answer.center_error_m.norm(), 2) << i;
    EXPECT_LT(answer.error_m.norm(), 4) << i;
    EXPECT_LT(std::abs(answer.result.fix->height_agl_m - shot.height_m), 4 * answer.result.fix->height_sigma_m) << i;
    EXPECT_GE(answer.result.stats.landmarks_seen, answer.result.stats.landmarks_matched);
    EXPECT_GE(answer.result.stats.landmarks_matched, 3);
    nees += mahalanobis_squared(answer.error_m, answer.result.fix->covariance_en_m2);
  }
  EXPECT_GE(fixes, least);
  EXPECT_LT(nees / fixes, 3) << "2 of honest covariances";
}

TEST(FixByLandmarks, GroundWithoutFeaturesIsFoundByItsLandmarks) {
  expect_fixes_by_landmarks(disc_map(1), 20, 6);
}

// Roofs all over, none of which is seen, neither link the discs to one group nor speak against the place.
TEST(FixByLandmarks, ACrowdOfAnotherClassTakesNothingFromThem) {
  ShotMap map = disc_map(1);
  testing::TexturedGround ground = map.ground;
  MapDetector roofs = ground.landmarks->detectors.front();
  roofs.detector.class_name = "roof";
  roofs.detector.threshold = 1000;
  ground.landmarks->detectors.push_back(roofs);
  for (int east = -5; east <= 5; ++east) {
    for (int north = -5; north <= 5; ++north) {
      MapLandmark roof = ground.landmarks->landmarks.front();
      roof.id = std::ssize(ground.landmarks->landmarks);
      roof.detector = 1;
      roof.place = map.place(25 * east, 25 * north);
      ground.landmarks->landmarks.push_back(roof);
    }
  }
  FeatureOptions hardly_any;
  hardly_any.features_per_mpx = 40;
  expect_fixes_by_landmarks(ShotMap(ground, hardly_any), 20, 6);
}

TEST(FixByLandmarks, OverReliefToo) {
  const auto hill = [](const Vector2d& m) { return 200 + 0.06 * m.x() + 3 * std::sin(m.y() / 30); };
  expect_fixes_by_landmarks(disc_map(1, hill), 15, 4);
}

/// A map that stores but a tile that no frame shows, full of features and with a chip.
void store_one_tile(ShotMap& map) {
  map.ground.only_first_tile = true;
  write_textured_map(map.path, map.ground);
}
constexpr int kTilesOfLargeGround = 8;

TEST(FixByLandmarks, GroundThatIsNotStoredIsFoundByItsLandmarks) {
  ShotMap map = disc_map(1, {}, kTilesOfLargeGround);
  store_one_tile(map);
  expect_fixes_by_landmarks(map, 20, 6, MatchStatus::kNoMap);
}

TEST(FixByLandmarks, OverReliefThatIsNotStoredToo) {
  const auto hill = [](const Vector2d& m) { return 200 + 0.06 * m.x() + 3 * std::sin(m.y() / 30); };
  ShotMap map = disc_map(1, hill, kTilesOfLargeGround);
  store_one_tile(map);
  expect_fixes_by_landmarks(map, 30, 4, MatchStatus::kNoMap);  // few heights leave much open
}

TEST(FixByLandmarks, AFixOverGroundThatIsNotStoredHasNoTileAndTheMapsWorstError) {
  ShotMap map = disc_map(1, {}, kTilesOfLargeGround);
  map.ground.map_sigma_m = 2.5;
  store_one_tile(map);
  Random random(11);
  int fixes = 0;
  for (int i = 0; i < 20; ++i) {
    const ShotAnswer answer = match_shot(map, random_shot(random), by_features_and_landmarks(true, true));
    EXPECT_EQ(answer.result.stats.map_features, 0) << "those of the tile have no place on this grid";
    EXPECT_EQ(answer.result.stats.chip_pixels, 0);
    if (!answer.result.fix) continue;
    ++fixes;
    EXPECT_FALSE(answer.result.fix->tile_id);
    EXPECT_EQ(answer.result.fix->map_sigma_m, 2.5);
  }
  EXPECT_GE(fixes, 6);
}

/// Frames of other ground, and of this ground searched in a window beside it.
void expect_no_fix_elsewhere(const ShotMap& map) {
  ShotMap other = disc_map(2, {}, map.ground.tiles);
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

TEST(FixByLandmarksThorough, OtherGroundAndOtherWindowsGiveNoFix) {
  expect_no_fix_elsewhere(disc_map(1));
  ShotMap map = disc_map(1, {}, kTilesOfLargeGround);
  store_one_tile(map);
  expect_no_fix_elsewhere(map);
}

TEST(FixByLandmarks, AMapWithLandmarksIsAsGoodByItsFeatures) {
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
