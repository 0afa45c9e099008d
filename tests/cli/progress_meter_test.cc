#include "progress_meter.h"

#include <chrono>
#include <sstream>
#include <thread>

#include "testing/json_schema.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace pilotage {
namespace {

using ::testing::HasSubstr;

TEST(ProgressBar, TellsShareRateAndTimeLeft) {
  EXPECT_EQ(progress_bar("score", 30, 120, 15, 80), "score [#######.......................] 25 %  15/s  6 s left");
  EXPECT_EQ(progress_bar("score", 120, 120, 60, 80), "score [##############################] 100 %  60/s  0 s left");
  EXPECT_THAT(progress_bar("score", 1, 1000, 0.1, 80), HasSubstr("0 %  0.1/s  2 h 46 min left"));
  EXPECT_EQ(progress_bar("read", 12, 0, 6, 80), "read 12  6.0/s");
  EXPECT_EQ(progress_bar("read", 0, 0, 0, 80), "read ...");
  EXPECT_EQ(progress_bar("read", 0, 10, 0, 80), "read [..............................] 0 %");
}

TEST(ProgressBar, FitsTheTerminal) {
  for (const int width : {0, 1, 10, 20, 40, 79, 200}) {
    EXPECT_LE(progress_bar("score tiles", 5, 9, 1, width).size(), static_cast<std::size_t>(width));
  }
  EXPECT_EQ(progress_bar("x", 20, 10, 1, 20).find("200 %"), std::string::npos) << "more done than there is";
}

TEST(ProgressMeter, JsonTellsTheFirstAndTheLastOfEachWork) {
  std::ostringstream stream;
  ProgressMeter meter(stream, ProgressStyle::kJson, 80, false);
  for (int done = 0; done <= 1000; ++done) meter.report("a", done, 1000);
  meter.report("b\xFF", 0, 2);
  meter.report("b\xFF", 2, 2);
  meter.report("b\xFF", 2, 2);  // asked again whether to go on: nothing new
  std::istringstream lines(stream.str());
  std::vector<nlohmann::json> parsed;
  for (std::string line; std::getline(lines, line);) parsed.push_back(nlohmann::json::parse(line));
  ASSERT_GE(parsed.size(), 4U);
  EXPECT_EQ(parsed.front()["what"], "a");
  EXPECT_EQ(parsed.front()["done"], 0);
  EXPECT_EQ(parsed[parsed.size() - 3]["done"], 1000);
  EXPECT_EQ(parsed.back()["done"], 2);
  EXPECT_EQ(parsed.back()["total"], 2);
  EXPECT_GE(parsed.back()["elapsed_s"].get<double>(), 0);
}

std::vector<nlohmann::json> parse_lines(const std::string& text) {
  std::vector<nlohmann::json> parsed;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    parsed.push_back(nlohmann::json::parse(line));
    EXPECT_EQ(testing::schema_violation("progress.json", parsed.back()), "");
  }
  return parsed;
}

TEST(ProgressMeter, WorkThatStopsEarlyShowsItsLastReport) {
  std::ostringstream stream;
  ProgressMeter meter(stream, ProgressStyle::kJson, 80, false);
  for (int done = 0; done < 7; ++done) meter.report("a", done, 1000);
  for (int done = 0; done < 9; ++done) meter.report("b", done, 0);
  meter.clear();
  const auto lines = parse_lines(stream.str());
  ASSERT_EQ(lines.size(), 4U);
  EXPECT_EQ(lines[1]["done"], 6);
  EXPECT_EQ(lines[3]["done"], 8);
  EXPECT_TRUE(lines[3]["remaining_s"].is_null()) << "nobody knows of how much";
}

TEST(ProgressMeter, WhatWasDoneBeforeDoesNotCountForTheRate) {
  std::ostringstream stream;
  ProgressMeter meter(stream, ProgressStyle::kJson, 80, false);
  meter.report("a", 900, 1000);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  meter.report("a", 910, 1000);
  meter.clear();
  const auto lines = parse_lines(stream.str());
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_TRUE(lines[0]["remaining_s"].is_null());
  EXPECT_GT(lines[1]["remaining_s"].get<double>(), 0.1) << "90 are left, 10 took at least 20 ms";
}

TEST(ProgressMeter, AFallingCountBeginsAnew) {
  std::ostringstream stream;
  ProgressMeter meter(stream, ProgressStyle::kJson, 80, false);
  for (int level = 0; level < 2; ++level) {
    for (int done = 0; done <= 3; ++done) meter.report("a", done, 3);
  }
  EXPECT_EQ(parse_lines(stream.str()).size(), 4U);
}

TEST(ProgressMeter, TheBarIsTakenAway) {
  std::ostringstream stream;
  ProgressMeter meter(stream, ProgressStyle::kBar, 40, true);
  meter.clear();
  EXPECT_EQ(stream.str(), "");
  meter.report("a", 0, 10);
  meter.clear();
  EXPECT_EQ(stream.str().substr(stream.str().rfind('\r')), "\r\x1b[K");
}

TEST(ProgressMeter, PlainTerminalsGetBlanksInsteadOfEscapes) {
  std::ostringstream stream;
  ProgressMeter meter(stream, ProgressStyle::kBar, 40, false);
  meter.report("a", 0, 10);
  meter.clear();
  EXPECT_EQ(stream.str().find('\x1b'), std::string::npos);
}

TEST(ProgressMeter, NoneIsSilent) {
  std::ostringstream stream;
  ProgressMeter meter(stream, ProgressStyle::kNone, 40, true);
  meter.report("a", 0, 10);
  meter.clear();
  EXPECT_EQ(stream.str(), "");
}

}  // namespace
}  // namespace pilotage
