#include "pilotage/replay/replayed_frame.h"

#include <gtest/gtest.h>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

constexpr const char* kTable =
    "file,time_s,status,lon_deg,lat_deg,east_sigma_m,north_sigma_m,covariance_en_m2,error_m\n"
    "a.jpg,0,fix,16.5,55.5,1.5,1.5,0,0.5\n"
    "b.jpg,10,inconsistent,,,,,,\n"
    "c.jpg,20,fix,16.502,55.5,1,1,0,9\n"
    "d.jpg,30,fix,16.506,55.5,1,1,0,\n"
    "e.jpg,40,unreadable,,,,,,\n"
    "f.jpg,200,ambiguous,,,,,,\n";

TEST(FixTable, OutcomesAndPlaces) {
  const std::vector<ReplayedFrame> frames = frames_of_fix_table("fixes.csv", kTable, {}, 5);
  ASSERT_EQ(frames.size(), 6U);
  EXPECT_EQ(frames[0].outcome, Outcome::kCorrect);
  EXPECT_EQ(frames[1].outcome, Outcome::kRefused);
  EXPECT_EQ(frames[2].outcome, Outcome::kFalse);
  EXPECT_EQ(frames[3].outcome, Outcome::kUnjudged);
  EXPECT_EQ(frames[4].outcome, Outcome::kNotTried);
  EXPECT_EQ(frames[0].place_from, PlaceSource::kFix);
  EXPECT_EQ(frames[1].place_from, PlaceSource::kBetweenFixes);
  EXPECT_NEAR(frames[1].place.lon_deg, 16.502, 1e-9) << "a third of the way from a to d: the false fix is no place";
  EXPECT_EQ(frames[5].place_from, PlaceSource::kNone) << "170 s from any fix";
  EXPECT_FALSE(frames[0].inertial_error);
}

TEST(FixTable, FramesBesideItSayPriorAndTruth) {
  FrameRecord record;
  record.file = "b.jpg";
  record.prior = {16.6, 55.6};
  record.true_nadir = GeodeticPoint{16.61, 55.61};
  record.height_agl_m = 120;
  FrameRecord first = record;
  first.file = "a.jpg";
  first.prior = {16.5, 55.5001};
  first.prior_covariance_en_m2 << 900, 0, 0, 900;
  const std::vector<FrameRecord> rows{record, first};
  const std::vector<ReplayedFrame> frames = frames_of_fix_table("fixes.csv", kTable, rows, 5);
  EXPECT_EQ(frames[1].place_from, PlaceSource::kTruth);
  EXPECT_EQ(frames[1].place.lon_deg, 16.61);
  EXPECT_EQ(frames[1].height_agl_m, 120);
  ASSERT_TRUE(frames[0].inertial_error);
  EXPECT_NEAR(frames[0].inertial_error->error_m.y(), 11.133, 0.05);  // 1e-4° of latitude, the prior's part taken out
}

TEST(FixTable, FixSurerThanTheMapSaysNothingOfTheInertialSystem) {
  FrameRecord record;
  record.file = "c.jpg";
  record.prior = {16.5, 55.5};
  record.prior_covariance_en_m2 << 900, 0, 0, 900;
  const std::vector<FrameRecord> rows{record};
  const std::vector<ReplayedFrame> frames = frames_of_fix_table("fixes.csv", kTable, rows, 5);
  EXPECT_TRUE(frames[2].prior);
  EXPECT_FALSE(frames[2].inertial_error) << "its sigma is that of the map alone";
}

TEST(FixTable, WhatIsWrongIsNamed) {
  const auto error_of = [](const std::string& text) {
    try {
      frames_of_fix_table("fixes.csv", text, {}, 5);
    } catch (const DataError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_NE(error_of("file,time_s\na,1\n").find("column \"status\" is missing"), std::string::npos);
  EXPECT_NE(error_of("file,time_s,status,lon_deg,lat_deg\na,1,fix,,\n").find("line 2: status is \"fix\", but lon_deg"),
            std::string::npos);
  EXPECT_NE(error_of("file,time_s,status,lat_deg\na,1,fix,95\n").find("lat_deg = \"95\" is not a number in [-90, 90]"),
            std::string::npos);
  EXPECT_NE(error_of("file,time_s,status\n").find("has no frame"), std::string::npos);
}

}  // namespace
}  // namespace pilotage
