#include "pilotage/report/landmark_note.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/mapdb/map_landmarks.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

using Eigen::Vector2d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr double kTileSide_m = 300;
const Vector2d kCorner_m(500'000, 5'000'000);

/// A row of tiles, 300 m wide at 0.5 m, with a route of one leg over the middle of each.
Mission mission_over(int tiles) {
  Mission mission;
  mission.ground.crs = Crs::from_user_input("EPSG:32633");
  GridLevel level;
  level.gsd_m = 0.5;
  level.min_agl_m = 200;
  level.max_agl_m = 300;
  level.matrix.map_from_pixel = GeoTransform::north_up(kCorner_m.x(), kCorner_m.y() + kTileSide_m, level.gsd_m);
  level.matrix.tile_size_px = level.matrix.stride_px = 600;
  level.matrix.grid_width_px = 600 * tiles;
  level.matrix.grid_height_px = 600;
  mission.ground.levels.push_back(level);
  mission.flight.max_error_m = 40;
  mission.flight.camera.width_px = mission.flight.camera.height_px = 600;  // 300 m wide from the level's middle
  mission.flight.camera.fx_px = mission.flight.camera.fy_px = 500;
  mission.flight.camera.cx_px = mission.flight.camera.cy_px = 300;
  for (int i = 0; i < tiles; ++i) {
    GroundTile tile;
    tile.tile_id = i;
    tile.column = i;
    const double left_m = kCorner_m.x() + i * kTileSide_m;
    tile.bounds = {left_m, kCorner_m.y(), left_m + kTileSide_m, kCorner_m.y() + kTileSide_m};
    mission.ground.tiles.push_back(tile);
    FlightSample sample;
    sample.point_map_m = tile.bounds.center_m();
    sample.level = 0;
    sample.leg = i;
    sample.distance_m = i * kTileSide_m;
    mission.flight.samples.push_back(sample);
  }
  return mission;
}

MapLandmarks one_class(double p_detect, double false_alarms_per_km2) {
  MapDetector detector;
  detector.detector.class_name = "tank";
  detector.detector.gsd_m = 0.5;
  detector.detector.context = 2;
  detector.p_detect = p_detect;
  detector.false_alarms_per_km2 = false_alarms_per_km2;
  detector.sigma_m = 0.3;
  MapLandmarks landmarks;
  landmarks.detectors.push_back(detector);
  return landmarks;
}

/// Landmarks on a circle about the middle of a tile, at uneven distances from each other, others for each tile.
void add_ring(MapLandmarks& landmarks, int tile, int count, double radius_m = 100) {
  const CrsTransform transform(Crs::from_user_input("EPSG:32633"));
  const Vector2d middle_m = kCorner_m + Vector2d((tile + 0.5) * kTileSide_m, kTileSide_m / 2);
  for (int i = 0; i < count; ++i) {
    const double angle = 0.4 * tile + 2 * std::numbers::pi * (i + 0.12 * ((3 * i + 2 * tile) % 5 - 2)) / count;
    MapLandmark landmark;
    landmark.id = std::ssize(landmarks.landmarks);
    landmark.place = *transform.geodetic_from_map(middle_m + radius_m * Vector2d(std::cos(angle), std::sin(angle)));
    landmark.length_m = 20;
    landmark.found = true;
    landmark.ambiguity = kNaN;
    landmark.ground_height_m = kNaN;
    landmarks.landmarks.push_back(landmark);
  }
}

TEST(LandmarkNote, PIsThatEnoughGroupsAreSeen) {
  MapLandmarks landmarks = one_class(1, 0);
  add_ring(landmarks, 0, 6);
  add_ring(landmarks, 1, 2);
  const LandmarkNote note = landmark_note(mission_over(3), landmarks, {0.1, 0.1, 0.1});
  // Six groups, each seen with 0.8: P of five at least is 0.655, of four at least 0.901.
  const double five = 6 * std::pow(0.8, 5) * 0.2 + std::pow(0.8, 6);
  const double four = five + 15 * std::pow(0.8, 4) * 0.04;
  EXPECT_THAT(note.p_fix[0], ::testing::AnyOf(::testing::DoubleNear(five, 1e-9), ::testing::DoubleNear(four, 1e-9)));
  EXPECT_EQ(note.p_fix[1], 0) << "two make no place";
  EXPECT_EQ(note.p_fix[2], 0);
  EXPECT_EQ(note.legs[0].landmarks, 6);
  EXPECT_EQ(note.legs[1].landmarks, 2);
  EXPECT_TRUE(note.legs[0].gains);
  EXPECT_FALSE(note.legs[1].gains);
  EXPECT_EQ(note.legs[0].distance_m, 0);
  EXPECT_TRUE(std::isnan(note.legs[2].distance_m));
  EXPECT_EQ(note.classes[0].landmarks, 8);
}

TEST(LandmarkNote, WorseDetectorsAndWiderLimitsPromiseLess) {
  const auto p_of = [](double p_detect, double false_alarms_per_km2, double limit_m) {
    MapLandmarks landmarks = one_class(p_detect, false_alarms_per_km2);
    add_ring(landmarks, 0, 6);
    Mission mission = mission_over(1);
    mission.flight.max_error_m = limit_m;
    return landmark_note(mission, landmarks, {0}).p_fix[0];
  };
  const double best = p_of(1, 0, 40);
  EXPECT_GT(best, 0.6);
  EXPECT_LT(p_of(0.6, 0, 40), best);
  EXPECT_LT(p_of(1, 200, 40), best);
  EXPECT_LT(p_of(1, 0, 1500), best);
}

TEST(LandmarkNote, WhatIsNotShownWholeOrWasNotFoundOrStandsTogetherDoesNotCount) {
  const auto p_of = [](const auto& change, double radius_m = 100) {
    MapLandmarks landmarks = one_class(1, 0);
    add_ring(landmarks, 0, 6, radius_m);
    change(landmarks);
    return landmark_note(mission_over(1), landmarks, {0});
  };
  const auto as_it_is = [](MapLandmarks&) {};
  EXPECT_GT(p_of(as_it_is, 121).p_fix[0], 0.6) << "the detector's square lies within, at any heading";
  EXPECT_LT(p_of(as_it_is, 175).p_fix[0], 0.3) << "only corners show them";
  EXPECT_EQ(p_of(as_it_is, 200).legs[0].landmarks, 0) << "beyond the corners";
  EXPECT_EQ(p_of(as_it_is, 40).p_fix[0], 0) << "40 m apart: one group";
  EXPECT_EQ(p_of([](MapLandmarks& all) {
              for (MapLandmark& one : all.landmarks) one.found = false;
            }).p_fix[0],
            0);
}

TEST(LandmarkNote, AnOblongFrameShowsMoreAlongItsLongSide) {
  MapLandmarks landmarks = one_class(1, 0);
  add_ring(landmarks, 0, 6, 175);  // beyond the square's sides
  Mission mission = mission_over(1);
  const double square = landmark_note(mission, landmarks, {0}).p_fix[0];
  mission.flight.camera.width_px = 1000;  // 500 by 300 m
  const LandmarkNote oblong = landmark_note(mission, landmarks, {0});
  EXPECT_GE(oblong.legs[0].landmarks, 6);
  EXPECT_GT(oblong.p_fix[0], square);
  EXPECT_LT(oblong.p_fix[0], 0.7) << "not at every heading";
  mission.flight.camera.height_px = 1000;
  EXPECT_GT(landmark_note(mission, landmarks, {0}).p_fix[0], 0.65);
}

TEST(LandmarkNote, MoreLandmarksPromiseNoLess) {
  MapLandmarks landmarks = one_class(0.9, 0);
  Mission mission = mission_over(1);
  mission.flight.camera.width_px = mission.flight.camera.height_px = 3000;  // 1,500 m wide
  const CrsTransform transform(mission.ground.crs);
  Random random(5);
  std::vector<Vector2d> places_m;
  double before = 0;
  for (const std::size_t count : {5U, 10U, 20U, 40U}) {
    while (places_m.size() < count) {
      const Vector2d place_m(random.uniform(-500, 500), random.uniform(-500, 500));
      const bool beside = std::any_of(places_m.begin(), places_m.end(),
                                      [&](const Vector2d& other_m) { return (other_m - place_m).norm() < 65; });
      if (beside) continue;
      places_m.push_back(place_m);
      MapLandmark landmark;
      landmark.id = std::ssize(landmarks.landmarks);
      landmark.place = *transform.geodetic_from_map(mission.ground.tiles[0].bounds.center_m() + place_m);
      landmark.length_m = 20;
      landmark.found = true;
      landmarks.landmarks.push_back(landmark);
    }
    const double p = landmark_note(mission, landmarks, {0}).p_fix[0];
    EXPECT_GE(p, before) << count;
    before = p;
  }
  EXPECT_GT(before, 0.99) << "more groups than are told apart";
}

TEST(LandmarkNote, NothingIsGainedOverWhatIsNotKnown) {
  MapLandmarks landmarks = one_class(1, 0);
  for (const int tile : {0, 2}) add_ring(landmarks, tile, 6);
  const LandmarkNote note = landmark_note(mission_over(3), landmarks, {0.1, 0.1, kNaN});
  EXPECT_GT(note.p_fix[0], 0.6);
  EXPECT_TRUE(note.legs[0].gains);
  EXPECT_GT(note.p_fix[2], 0.6);
  EXPECT_FALSE(note.legs[2].gains);
}

TEST(LandmarkNote, PixelsThatTheDetectorWasNotTriedOnDoNotCount) {
  MapLandmarks landmarks = one_class(1, 0);
  add_ring(landmarks, 0, 6);
  Mission mission = mission_over(1);
  EXPECT_THAT(landmark_note(mission, landmarks, {0}).assumes, ::testing::Not(HasSubstr("Not counted")));
  mission.flight.camera.width_px = mission.flight.camera.height_px = 300;  // pixels of 1 m, the detector's are 0.5
  mission.flight.camera.fx_px = mission.flight.camera.fy_px = 250;
  mission.flight.camera.cx_px = mission.flight.camera.cy_px = 150;
  const LandmarkNote note = landmark_note(mission, landmarks, {0});
  EXPECT_EQ(note.p_fix[0], 0);
  EXPECT_THAT(note.assumes, HasSubstr("Not counted: tank, for the camera's pixels"));
}

TEST(LandmarkNote, SaysWhichLegsGainAndWhatItAssumes) {
  MapLandmarks landmarks = one_class(1, 0);
  for (const int tile : {0, 1, 2}) add_ring(landmarks, tile, 6);
  const LandmarkNote note = landmark_note(mission_over(4), landmarks, {0.2, 0.999, 0.3, 0.2});
  EXPECT_THAT(landmark_sentences(note), ElementsAre(HasSubstr("18 landmarks of 1 class (tank): legs 1 (P 0."),
                                                    HasSubstr("Modelled, not measured")));
  EXPECT_THAT(landmark_sentences(note)[0], HasSubstr("and 3 (P 0."));
  EXPECT_THAT(landmark_sentences(note)[0], HasSubstr("gain a fix by landmarks alone"));
  const auto json = landmark_json(note);
  EXPECT_EQ(json["legs"][1]["gains"], false) << "features are better there";
  EXPECT_EQ(json["legs"][0]["leg"], 1);
  EXPECT_TRUE(json["legs"][3]["distance_m"].is_null());
  EXPECT_THAT(landmark_html(note), HasSubstr("<td data-label=\"Landmarks shown\">6</td>"));
  const LandmarkNote none = landmark_note(mission_over(4), landmarks, {0.99, 0.99, 0.99, 0.2});
  EXPECT_THAT(landmark_sentences(none)[0], HasSubstr("no leg gains a fix"));
}

}  // namespace
}  // namespace pilotage
