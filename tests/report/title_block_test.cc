#include "pilotage/report/title_block.h"

#include <cmath>
#include <cstdlib>
#include <map>

#include "report/report_scene.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::HasSubstr;

std::map<std::string, std::string> by_label(const ReportInput& input) {
  const auto block = title_block(input);
  return {block.begin(), block.end()};
}

ReportInput flown_scene() {
  ReportInput input = testing::report_scene({});
  Flight& flight = input.mission.flight;
  // Two legs; each has samples at both of its ends.
  flight.samples.resize(4);
  for (std::size_t i = 0; i < 4; ++i) {
    const double vertex = i < 2 ? static_cast<double>(i) : static_cast<double>(i - 1);
    flight.samples[i].distance_m = 300.0 * vertex;
    flight.samples[i].speed_mps = i < 2 ? 10 : 30;
    flight.samples[i].agl_m = 100.0 + 20.0 * vertex;
  }
  flight.camera = {};
  flight.camera.width_px = 4000;
  flight.camera.height_px = 3000;
  flight.camera.fx_px = flight.camera.fy_px = 2000;
  return input;
}

TEST(TitleBlock, SaysWhatIsFlownWithWhat) {
  const auto block = by_label(flown_scene());
  // 300 m at 10 m/s and 300 m at 30 m/s.
  EXPECT_EQ(block.at("Flight time"), "40 s: length over speed, without wind, climbs and turns");
  EXPECT_EQ(block.at("Speed"), "10.0 to 30.0 m/s");
  EXPECT_EQ(block.at("Height"), "100 to 140 m above ground");
  EXPECT_EQ(block.at("Camera"), "4000 × 3000 px, 90.0° wide");
}

TEST(TitleBlock, TheRoutesCameraIsNamedOnlyWhereItFlies) {
  ReportInput input = flown_scene();
  Flight& flight = input.mission.flight;
  RouteCamera named;
  named.name = "Survey 24";
  named.sensor_width_mm = 36;
  named.sensor_height_mm = 27;
  named.focal_length_mm = 18;
  named.image_width_px = 4000;
  named.image_height_px = 3000;
  flight.route.camera = named;
  EXPECT_EQ(by_label(input).at("Camera"), "Survey 24, 4000 × 3000 px, 90.0° wide");
  flight.camera.fx_px = flight.camera.fy_px = 4000;  // the planner gave another
  EXPECT_EQ(by_label(input).at("Camera"), "4000 × 3000 px, 53.1° wide");
}

TEST(TitleBlock, WhatIsNotKnownIsNotSaid) {
  ReportInput input = flown_scene();
  for (FlightSample& sample : input.mission.flight.samples) sample.speed_mps = std::nan("");
  const auto block = by_label(input);
  EXPECT_EQ(block.count("Speed"), 0U);
  EXPECT_EQ(block.count("Flight time"), 0U);
}

TEST(TitleBlock, ImageryHasItsDates) {
  ReportInput input = flown_scene();
  input.mission.ground.imagery.datasets.resize(3);
  input.mission.ground.imagery.datasets[0].acquired = "2020-07-01";
  input.mission.ground.imagery.datasets[1].acquired = "2019-08-14";
  input.mission.ground.imagery.datasets[2].acquired = "2020-07-01";
  EXPECT_EQ(by_label(input).at("Imagery"), "2019-08-14, 2020-07-01");
  input.mission.ground.imagery.datasets[1].acquired.clear();
  EXPECT_THAT(by_label(input).at("Imagery"), HasSubstr("date not known"));
}

TEST(TitleBlock, TheDateIsThatOfTheEnvironment) {
  EXPECT_EQ(by_label(flown_scene()).count("Made"), 0U);
  ::setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  const auto block = by_label(flown_scene());
  ::unsetenv("SOURCE_DATE_EPOCH");
  EXPECT_THAT(block.at("Made"), HasSubstr("2023-11-14"));
}

}  // namespace
}  // namespace pilotage
