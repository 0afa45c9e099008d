#include "pilotage/survey/survey.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/nan.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/raster/gdal_crs.h"

namespace pilotage {
namespace {

// Ten tiles in a row, `go` of them found often, one seldom, the others never.
SurveyInput ten_tiles(int go) {
  SurveyInput input;
  SurveyedGround& area = input.area;
  area.camera.width_px = 4000;
  area.camera.height_px = 3000;
  area.camera.fx_px = area.camera.fy_px = 4000;
  area.agl_m = 120;
  area.footprint_width_m = 120;
  area.footprint_height_m = 90;
  area.search_radius_m = 50;
  Ground& ground = area.ground;
  ground.crs = Crs::from_user_input("EPSG:32633");
  GridLevel level;
  level.gsd_m = 0.6;
  level.min_agl_m = level.max_agl_m = 120;
  level.search_radius_px = 84;
  level.matrix = {0, GeoTransform::north_up(500010, 5'000'900, 0.6), 1100, 200, 200, 100};
  ground.levels.push_back(level);
  ground.imagery.datasets.push_back({"folder/<b>ortho</b>.tif", 0.5, "UTM", "2023-06-14", 1320, 240});
  cut_all_tiles(ground, 1);
  for (int i = 0; i < 10; ++i) {
    TileScores tile;
    tile.valid_fraction = 1;
    tile.p_correct_fix = i < go ? 0.9 : i == go ? 0.3 : 0;
    if (i >= go) tile.reasons = {ReasonCode::kWater};
    input.scores.push_back(tile);
  }
  input.geodetic_from_map = [crs = ground.crs](const Eigen::Vector2d& point) {
    return CrsTransform(crs).geodetic_from_map(point).value();
  };
  return input;
}

TEST(Survey, HeadlineSaysTheShareOfTheAreaAndNoVerdict) {
  const Survey survey = make_survey(ten_tiles(7));
  EXPECT_EQ(survey.headline, "a fix may be expected over 70 % of the area: 0.03 km² of 0.04 km²");
  EXPECT_THAT(survey.detail, ::testing::StartsWith("marginal 0.00 km² (10 %), no-go 0.01 km² (20 %); median P(correct "
                                                   "fix) 0.90; no place is farther than 180 m from go ground"));
  const std::string html = survey_html(survey);
  const std::string told = html.substr(0, html.find("<script"));  // a route that is drawn on the page has one
  EXPECT_THAT(told, ::testing::Not(::testing::HasSubstr("NO-GO")));
}

TEST(Survey, SaysWhatItAssumesAndWhatItDidNotLookAt) {
  SurveyInput input = ten_tiles(7);
  const std::string page = survey_html(make_survey(input));
  for (const char* said : {"4000 × 3000 px, 53.1° wide, looking straight down in level flight from 120 m above ground",
                           "on a map without chips", "known to within 50 m", "imagery: 2023-06-14; no second date",
                           "modelled from one date", "these are 200 px at 0.60 m/px", "Not looked at: a route"}) {
    EXPECT_THAT(page, ::testing::HasSubstr(said));
  }
  EXPECT_THAT(page, ::testing::Not(::testing::HasSubstr("beyond what was tested")));
  input.area.ground.levels.front().gsd_m = 0.9;
  input.area.search_radius_assumed = true;
  input.matcher = FlyingMatcher::kFeaturesAndChips;
  input.model = "here.json";
  input.second_dates.push_back({"later.tif", 0.5, "UTM", "2024-09", 10, 10});
  const std::string other = survey_html(make_survey(input));
  for (const char* said : {"features and chips", "(default)", "second date: 2024-09",
                           "with the parameters of here.json", "at 0.90 m/px: beyond what was tested"}) {
    EXPECT_THAT(other, ::testing::HasSubstr(said));
  }
}

// Without P the ground is judged by margins, and nobody may read that as how often fixes come.
TEST(Survey, SaysWhatGoGroundIsLeftLaterWherePCountsTheAge) {
  SurveyInput input = ten_tiles(7);
  EXPECT_THAT(make_survey(input).detail, ::testing::Not(::testing::HasSubstr("a year later")));
  input.area.ground.imagery.datasets.resize(1);
  input.area.ground.imagery.datasets[0].acquired = "2025-06-01";
  input.area.ground.flight_time = "2026-06-01";
  for (std::size_t i = 0; i < 10; ++i) {
    input.scores[i].p_correct_fix = i < 4 ? 0.9 : i < 7 ? 0.53 : 0.3;
    input.scores[i].level_sigma = 1;
    input.scores[i].level_age_months = 12;
  }
  const Survey survey = make_survey(input);
  EXPECT_THAT(survey.detail,
              ::testing::HasSubstr("; go is 40 % of the area a year later and 40 % two years later (by a rule of"));
  EXPECT_GT(survey.tiles[5].half_found_until, "2026-06-01");
  EXPECT_EQ(survey.tiles[9].half_found_until, "");
  input.area.ground.flight_time = "2024-06-01";
  EXPECT_THAT(make_survey(input).detail, ::testing::Not(::testing::HasSubstr("a year later")))
      << "later flights are nearer to the imagery";
}

TEST(Survey, WithoutAProbabilityNoFixIsPromised) {
  SurveyInput input = ten_tiles(7);
  for (TileScores& tile : input.scores) {
    tile.degraded.margin = tile.p_correct_fix > 0.5 ? 0.2 : -0.1;
    tile.p_correct_fix = std::numeric_limits<double>::quiet_NaN();
  }
  const Survey survey = make_survey(input);
  EXPECT_EQ(survey.headline,
            "the ground stands out from all around over 70 % of the area: 0.03 km² of 0.04 km²; how often fixes come "
            "there is not known");
  EXPECT_THAT(survey.detail, ::testing::Not(::testing::HasSubstr("median")));
}

TEST(Survey, TableSaysWhatMakesASquareWeak) {
  const Survey survey = make_survey(ten_tiles(7));
  EXPECT_EQ(weak_because(survey.statistics), "open water (100 % of the weak ground)");
  EXPECT_EQ(weak_because(make_survey(ten_tiles(10)).statistics), "");
  EXPECT_THAT(squares_csv(survey), ::testing::EndsWith(",10,7,1,2,0,0.7,0.1,0.2,0.9,water\n"));
}

TEST(Survey, NamesFromFilesAreTextOnThePage) {
  const std::string page = survey_html(make_survey(ten_tiles(3)));
  EXPECT_THAT(page, ::testing::Not(::testing::HasSubstr("<b>ortho")));
  EXPECT_THAT(page, ::testing::HasSubstr("&lt;b&gt;ortho"));
}

/// A ring of eight landmarks, unevenly spaced, about the middle of the fifth tile.
MapLandmarks ring_of_tanks(const Ground& ground) {
  MapLandmarks landmarks;
  MapDetector detector;
  detector.detector.class_name = "tank";
  detector.detector.gsd_m = 0.6;
  detector.detector.context = 1.3;
  detector.p_detect = 1;
  detector.sigma_m = 0.3;
  landmarks.detectors.push_back(detector);
  const CrsTransform transform(ground.crs);
  const Eigen::Vector2d middle_m = ground.tiles[4].bounds.center_m();
  for (int i = 0; i < 8; ++i) {
    const double angle = 2 * std::numbers::pi * (i + 0.12 * ((3 * i) % 5 - 2)) / 8;
    const Eigen::Vector2d point_m =
        middle_m + (i % 2 == 0 ? 65.0 : 120.0) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    landmarks.landmarks.push_back({i, 0, transform.geodetic_from_map(point_m).value(), 8, kNaN, true, kNaN});
  }
  return landmarks;
}

TEST(Survey, SaysWhereLandmarksPromiseAFixAndCountsThemInNothing) {
  SurveyInput input = ten_tiles(3);
  const Survey without = make_survey(input);
  input.area.ground.levels.front().gsd_m = 1.8;              // tiles 360 m wide, 180 m apart
  input.area.camera.fx_px = input.area.camera.fy_px = 1333;  // as frames
  input.area.camera.cx_px = 2000;
  input.area.camera.cy_px = 1500;
  input.area.ground.levels.front().matrix.map_from_pixel = GeoTransform::north_up(500010, 5'000'900, 1.8);
  input.area.ground.tiles.clear();
  cut_all_tiles(input.area.ground, 1);
  input.landmarks = ring_of_tanks(input.area.ground);
  const Survey survey = make_survey(input);
  ASSERT_TRUE(survey.landmarks);
  EXPECT_EQ(survey.landmarks->strongest, 4U);
  EXPECT_GT(survey.tiles[4].p_landmark_fix, kLeastLandmarkGain);
  EXPECT_EQ(survey.tiles[9].p_landmark_fix, 0);
  EXPECT_EQ(survey.landmarks->likely_tiles, 1);
  EXPECT_EQ(survey.landmarks->gaining_tiles, 1) << "features find nothing there";
  EXPECT_THAT(
      survey.landmarks->said,
      ::testing::StartsWith("8 landmarks of 1 class (tank): a fix by landmarks alone may be expected over 10 % of the "
                            "area (0.03 km²), over 0.03 km² of it likelier than one by features; P is 0."));
  EXPECT_EQ(survey.go_share, without.go_share);
  const nlohmann::ordered_json json = survey_json(survey);
  EXPECT_EQ(json["landmarks"]["likely_tiles"], survey.landmarks->likely_tiles);
  EXPECT_EQ(json["tiles"]["columns"].back(), "p_landmark_fix");
  EXPECT_THAT(survey_html(survey), ::testing::HasSubstr("not counted in the headline or the classes of ground"));
  EXPECT_FALSE(survey_json(without).contains("landmarks"));
  EXPECT_THAT(survey_html(without), ::testing::Not(::testing::HasSubstr("Fixes by landmarks")));

  SurveyInput unknown = input;
  for (TileScores& tile : unknown.scores) tile.p_correct_fix = kNaN;
  EXPECT_EQ(make_survey(unknown).landmarks->gaining_tiles, 0);
  EXPECT_THAT(make_survey(unknown).landmarks->said, ::testing::Not(::testing::HasSubstr("likelier")));
  unknown = input;
  unknown.matcher = FlyingMatcher::kFeaturesAndChips;
  EXPECT_THAT(make_survey(unknown).landmarks->said, ::testing::HasSubstr("likelier than one by features and chips"));

  input.landmarks->landmarks.resize(2);
  const Survey two = make_survey(input);
  EXPECT_EQ(two.landmarks->said, "2 landmarks of 1 class (tank): nowhere may a fix by landmarks alone be expected");
}

}  // namespace
}  // namespace pilotage
