#include "pilotage/report/sketch.h"

#include <cmath>

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/report/page_text.h"
#include "pilotage/report/report.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

// The page's predictions themselves are held against the program by accept.sketch_page.
ReportInput scene_to_sketch_on() {
  ReportInput input = testing::report_scene_with_tries();
  input.selection.left_out = LeftOut{0.2, 0.05, {}};
  input.selection.probability = RouteProbability{0.9, 0.8, 0, 0, {}, {}};
  return input;
}

Json data_of(const ReportInput& input, const Json& mission_file = nullptr) {
  return sketch_data(input.mission, input.scores, input.selection, mission_file);
}

std::size_t tiles_of_runs(const Json& json) {
  std::size_t count = 0;
  for (const Json& run : json["sigma_runs"]) count += run[0].get<std::size_t>();
  return count;
}

TEST(Sketch, HasEveryTileAndTheEndsOfEveryLeg) {
  const ReportInput input = scene_to_sketch_on();
  const Json json = data_of(input);
  const std::size_t tiles = input.mission.ground.tiles.size();
  EXPECT_EQ(json["logits"].get<std::string>().size(), base64(std::string(tiles * sizeof(double), '\0')).size());
  EXPECT_EQ(tiles_of_runs(json), tiles);
  const Flight& flight = input.mission.flight;
  ASSERT_EQ(json["points"].size(), flight.route.legs.size() + 1);
  EXPECT_TRUE(json["points"][0][3].is_null());
  EXPECT_EQ(json["points"][1][3], 18);
  EXPECT_NEAR(json["points"][0][0].get<double>(), flight.samples.front().point.lon_deg, 1e-8);
  EXPECT_NEAR(json["points"].back()[1].get<double>(), flight.samples.back().point.lat_deg, 1e-8);
  EXPECT_EQ(json["min_route_probability"], 0.8);
}

TEST(Sketch, RoutesThatJumpAreNotStartedFrom) {
  ReportInput input = scene_to_sketch_on();
  input.mission.flight.route.legs.back().from = input.mission.flight.route.legs.front().from;
  EXPECT_TRUE(data_of(input)["points"].empty());
}

TEST(Sketch, LevelsAndWindsAreThoseOfTheProgram) {
  ReportInput input = scene_to_sketch_on();
  EXPECT_EQ(data_of(input)["level_weights"].size(), 1U) << "no tile says how well the level is known";
  for (TileScores& score : input.scores) score.level_sigma = 0.7;
  const Json json = data_of(input);
  EXPECT_EQ(json["level_weights"].size(), 9U);
  EXPECT_EQ(json["level_z"].size(), 9U);
  EXPECT_EQ(json["cases"].size(), 60U);
}

TEST(Sketch, IsNotOfferedWhereNothingSaysHowOftenFixesCome) {
  ReportInput input = scene_to_sketch_on();
  EXPECT_THAT(report_html(make_report(input)), HasSubstr("\"sketch\":{"));
  input.selection.probability.reset();
  EXPECT_TRUE(data_of(input).is_null());
  EXPECT_THAT(report_html(make_report(input)), HasSubstr("\"sketch\":null"));
}

TEST(Sketch, TheMissionAsksForTheSameTilesAndForNoRoute) {
  const ReportInput input = scene_to_sketch_on();
  const Ground& ground = input.mission.ground;
  EXPECT_TRUE(sketch_mission({{"seed", 1}}, ground).is_null()) << "options of another stage";
  const Json mission = sketch_mission(
      {{"imagery", {"a.tif"}}, {"route", "r.plan"}, {"speed_mps", 20}, {"denied", {"1-2"}}, {"agl_m", 100}}, ground);
  for (const char* gone : {"route", "speed_mps", "denied", "agl_m"}) EXPECT_FALSE(mission.contains(gone)) << gone;
  EXPECT_EQ(mission["imagery"], Json({"a.tif"}));
  EXPECT_EQ(mission["crs"], ground.crs.wkt());
  const TileMatrix& matrix = ground.levels.front().matrix;
  EXPECT_EQ(mission["grid_origin_m"], Json({matrix.map_from_pixel.origin_x, matrix.map_from_pixel.origin_y}));
}

}  // namespace
}  // namespace pilotage
