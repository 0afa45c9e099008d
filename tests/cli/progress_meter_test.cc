#include "progress_meter.h"

#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace pilotage {
namespace {

using ::testing::HasSubstr;

TEST(ProgressBar, TellsShareRateAndTimeLeft) {
  EXPECT_EQ(progress_bar("score", 30, 120, 2, 80), "score [#######.......................] 25 %  15/s  6 s left");
  EXPECT_EQ(progress_bar("score", 120, 120, 2, 80), "score [##############################] 100 %  60/s  0 s left");
  EXPECT_THAT(progress_bar("score", 1, 1000, 10, 80), HasSubstr("0 %  0.1/s  2 h 46 min left"));
  EXPECT_EQ(progress_bar("read", 12, 0, 2, 80), "read 12  6.0/s");
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
