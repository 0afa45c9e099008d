#include <limits>

#include "report/report_scene.h"
#include "testing/json_schema.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/nan.h"
#include "pilotage/report/report.h"

namespace pilotage {
namespace {

std::string violation(const nlohmann::ordered_json& report) {
  return testing::schema_violation("report.schema.json", report);
}

ReportInput short_scene() {
  testing::ReportSceneOptions options;
  options.matchable_from = 0.3;
  options.matchable_to = 0.9;
  options.tiles_along = 12;
  return testing::report_scene(options);
}

TEST(ReportJson, FollowsItsSchema) {
  EXPECT_EQ(violation(report_json(short_scene())), "");
  ReportInput empty;
  empty.geodetic_from_map = [](Eigen::Vector2d) { return GeodeticPoint{}; };
  EXPECT_EQ(violation(report_json(empty)), "");
}

TEST(ReportJson, SaysWhatLandmarksPromise) {
  Report report = make_report(short_scene());
  EXPECT_FALSE(report_json(report).contains("landmarks"));
  const std::size_t columns = report_json(report)["tiles"]["columns"].size();
  report.landmarks = LandmarkNote{{{"tank", 7, 0.95, 0.2, 0.3}}, {}, {{3, 0.7, 120, true}, {0, 0, kNaN, false}}, "all"};
  for (ReportTile& tile : report.tiles) tile.p_landmark_fix = 0.25;
  const auto json = report_json(report);
  EXPECT_EQ(violation(json), "");
  EXPECT_EQ(json["landmarks"]["legs"][0]["p_fix"], 0.7);
  EXPECT_EQ(json["tiles"]["columns"].size(), columns + 1);
  EXPECT_EQ(json["tiles"]["columns"].back(), "p_landmark_fix");
  EXPECT_EQ(json["tiles"]["rows"][0].back(), 0.25);
}

TEST(ReportJson, CarriesProbabilitiesAndRanksLegsByThem) {
  ReportInput input = short_scene();
  EXPECT_TRUE(report_json(input)["route"]["probability"].is_null());
  input.selection.probability = RouteProbability{0.8, 0.9, 41.5, 0.0021, WorstStretch{2, 1000, 1500.5, 0.08}, {}};
  for (LegStatus& leg : input.selection.legs) leg.p_within_limit = leg.leg == 3 ? 0.8 : 1;
  input.selection.legs[3].p_fix = 0.75;
  const auto json = report_json(input);
  EXPECT_EQ(violation(json), "");
  EXPECT_EQ(json["route"]["probability"]["p_within_limit"], 0.8);
  EXPECT_EQ(json["route"]["probability"]["worst"]["to_distance_m"], 1500.5);
  EXPECT_EQ(json["route"]["legs"][3]["p_fix"], 0.75);
  EXPECT_TRUE(json["route"]["legs"][0]["p_fix"].is_null());
  EXPECT_EQ(json["route"]["worst_legs"][0], 4) << "legs count from 1";
  EXPECT_EQ(json["route"]["legs"][3]["leg"], 4);
  EXPECT_EQ(json["route"]["legs"][3]["status"], "bad") << "P 0.8 is below the 0.9 asked for";
  EXPECT_EQ(json["route"]["legs"][0]["status"], "good");
  EXPECT_EQ(json["route"]["probability"]["worst"]["leg"], 3);
  EXPECT_EQ(json["verdict"]["status"], "NO-GO");
  EXPECT_NE(report_html(input).find("0.800</td><td data-label=\"P of a fix\">0.750</td>"), std::string::npos);
}

TEST(ReportJson, TheSchemaRefusesWhatIsWrong) {
  const nlohmann::ordered_json good = report_json(short_scene());
  nlohmann::ordered_json bad = good;
  bad["verdict"]["status"] = "MAYBE";
  EXPECT_NE(violation(bad), "");
  bad = good;
  bad["route"]["legs"][0].erase("max_error_m");
  EXPECT_NE(violation(bad), "");
  bad = good;
  bad["surprise"] = 1;
  EXPECT_NE(violation(bad), "");
  bad = good;
  bad["route"]["gaps"][0]["from"]["lon_deg"] = "7";
  EXPECT_NE(violation(bad), "");
}

TEST(ReportJson, WhatIsNotANumberIsNull) {
  ReportInput input = short_scene();
  input.selection.gaps[0].error_m = std::numeric_limits<double>::infinity();
  input.selection.legs[0].max_error_m = std::numeric_limits<double>::quiet_NaN();
  const auto json = report_json(input);
  EXPECT_TRUE(json["route"]["gaps"][0]["error_m"].is_null());
  EXPECT_TRUE(json["route"]["legs"][0]["max_error_m"].is_null());
  EXPECT_EQ(violation(json), "");
  EXPECT_EQ(json["verdict"]["status"], "NO-GO");
}

TEST(ReportJson, RowsHaveOneEntryPerColumnAndTheScoresNumbers) {
  const ReportInput input = short_scene();
  const auto json = report_json(input);
  const auto& columns = json["tiles"]["columns"];
  const auto index = [&](const std::string& name) {
    return static_cast<std::size_t>(std::find(columns.begin(), columns.end(), name) - columns.begin());
  };
  ASSERT_EQ(json["tiles"]["rows"].size(), input.scores.size());
  for (std::size_t i = 0; i < input.scores.size(); ++i) {
    const auto& row = json["tiles"]["rows"][i];
    ASSERT_EQ(row.size(), columns.size());
    EXPECT_EQ(row[index("tile_id")], input.mission.ground.tiles[i].tile_id);
    if (input.scores[i].status != TileStatus::kScored) continue;
    EXPECT_NEAR(row[index("degraded_peak_margin")].get<double>(), input.scores[i].degraded.margin, 1e-6);
    EXPECT_NEAR(row[index("frieden_entropy")].get<double>(), input.scores[i].frieden_entropy, 1e-11);
    EXPECT_NEAR(row[index("center_lon_deg")].get<double>(), input.mission.ground.tiles[i].center.lon_deg, 5.1e-8);
  }
  for (const auto& measure : json["measures"]) EXPECT_LT(index(measure["name"]), columns.size()) << measure["name"];
}

TEST(ReportJson, IsTheSameEachTime) {
  const ReportInput input = short_scene();
  EXPECT_EQ(report_json(input).dump(), report_json(input).dump());
}

}  // namespace
}  // namespace pilotage
