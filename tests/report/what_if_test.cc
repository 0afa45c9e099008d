#include "pilotage/report/what_if.h"

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/ins/ins_error_model.h"
#include "pilotage/report/page_text.h"

namespace pilotage {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::HasSubstr;

// The page's predictions themselves are held against the program by accept.what_if.
std::size_t samples_of(const Json& runs) {
  std::size_t count = 0;
  for (const Json& run : runs) count += run[0].get<std::size_t>();
  return count;
}

TEST(WhatIf, HasEverySampleOfTheFlight) {
  const ReportInput input = testing::report_scene_with_tries();
  const Json json = what_if_data(input, quality_rows(judged_plan(input)));
  const std::size_t count = input.mission.flight.samples.size();
  const std::string bytes(2 * sizeof(double) * count, '\0');
  EXPECT_EQ(json["samples"].get<std::string>().size(), base64(bytes).size());
  for (const char* runs : {"leg_runs", "speed_runs", "apart_runs", "tile_runs"}) {
    EXPECT_EQ(samples_of(json[runs]), count) << runs;
  }
  EXPECT_EQ(json["speed_runs"], Json({{count, 18.0}}));
  EXPECT_EQ(json["leg_runs"].size(), input.mission.flight.route.legs.size());
  EXPECT_EQ(json["fix_interval_s"], 2.5);
  EXPECT_EQ(json["max_error_m"], input.selection.max_error_m);
}

TEST(WhatIf, TilesThatAreNotStoredGiveNoFix) {
  ReportInput input = testing::report_scene_with_tries();
  input.selection.tile_ids.clear();
  EXPECT_EQ(what_if_data(input, {})["tile_runs"], Json({{input.mission.flight.samples.size(), nullptr}}));
}

TEST(WhatIf, GradesKeepTheFiguresOfOnesOwn) {
  ReportInput input = testing::report_scene_with_tries();
  input.mission.flight.ins.name = "VN-100";
  input.mission.flight.ins.gyro_bias_deg_h = 7;
  const Json models = what_if_data(input, {})["models"];
  ASSERT_EQ(models.size(), 6U) << "as planned, and the five grades";
  EXPECT_EQ(models[0]["text"], "VN-100 INS, with figures of your own");
  EXPECT_TRUE(models[0]["grade"].is_null());
  EXPECT_EQ(models[1]["grade"], "consumer");
  EXPECT_EQ(models[1]["text"], "consumer INS, with figures of your own");
  InsOptions consumer;
  consumer.grade = InsGrade::kConsumer;
  EXPECT_EQ(models[1]["accel_bias_mps2"], make_ins_error_model(consumer).accel_bias_mps2);
  EXPECT_EQ(models[1]["gyro_bias_radps"], models[0]["gyro_bias_radps"]) << "given, so it does not follow the grade";
}

TEST(WhatIf, IsNotOfferedWhereNothingSaysHowTriesAreMade) {
  ReportInput input = testing::report_scene_with_tries();
  EXPECT_THAT(report_html(input), HasSubstr("\"fix_interval_s\":2.5"));
  input.mission.flight.samples.back().speed_mps = 0;
  EXPECT_TRUE(what_if_data(input, {}).is_null());
  EXPECT_THAT(report_html(testing::report_scene({})), HasSubstr("\"what_if\":null"));
}

}  // namespace
}  // namespace pilotage
