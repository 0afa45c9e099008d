#include "pilotage/replay/log_frames.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/geo/geodesic.h"

namespace pilotage {
namespace {

/// Ten seconds northward at 220 m above the sea, a capture each second.
VehicleLog northward(bool captures) {
  VehicleLog log;
  for (int i = 0; i <= 10; ++i) {
    const GeodeticPoint point{16.5, 55.5 + 1e-4 * i};
    log.truth.positions.push_back({static_cast<double>(i), point, 220});
    log.estimate.positions.push_back({static_cast<double>(i), {point.lon_deg + 1e-4, point.lat_deg}, 221});
    log.estimate.attitudes.push_back({static_cast<double>(i), {0, 1, 2}});
    if (!captures) continue;
    LoggedCapture capture;
    capture.time_s = i;
    log.captures.push_back(capture);
  }
  return log;
}

InsErrorModel model() {
  InsOptions options;
  options.grade = InsGrade::kIndustrial;
  return make_ins_error_model(options);
}

TEST(LogFrames, PriorsOfTheAutopilot) {
  LogFrameOptions options;
  options.priors = LogPriors::kLog;
  options.ground_amsl_m = 100;
  const LogFrames frames = frames_of_log(northward(true), options, model(), false, 1);
  ASSERT_EQ(frames.rows.size(), 11U);
  EXPECT_NEAR(frames.rows[4].prior.lon_deg, 16.5001, 1e-9);
  EXPECT_EQ(frames.rows[4].prior_covariance_en_m2(0, 0), 900);
  EXPECT_NEAR(frames.rows[4].height_agl_m, 120, 1e-9);
  EXPECT_EQ(frames.rows[4].attitude.roll_deg, 2);
  ASSERT_TRUE(frames.rows[4].true_nadir);
  EXPECT_EQ(frames.rows[4].true_nadir->lon_deg, 16.5);
}

TEST(LogFrames, DrawnPriorsDriftAndAreTheSameForASeed) {
  LogFrameOptions options;
  options.ground_amsl_m = 100;
  const LogFrames one = frames_of_log(northward(true), options, model(), false, 1);
  const LogFrames again = frames_of_log(northward(true), options, model(), false, 1);
  const LogFrames other = frames_of_log(northward(true), options, model(), false, 2);
  EXPECT_EQ(one.rows[10].prior.lon_deg, again.rows[10].prior.lon_deg);
  EXPECT_NE(one.rows[10].prior.lon_deg, other.rows[10].prior.lon_deg);
  EXPECT_GT(one.rows[10].prior_covariance_en_m2(0, 0), one.rows[0].prior_covariance_en_m2(0, 0));
  EXPECT_LT(geodesic_between(one.rows[10].prior, *one.rows[10].true_nadir).length_m, 100);
}

TEST(LogFrames, RangeFinderGoesBeforeSeaLevelAndGroundIsAssumedWithANote) {
  VehicleLog log = northward(true);
  log.heights.push_back({5, 77});
  log.truth.positions[0].amsl_m = 90;
  const LogFrames frames = frames_of_log(log, {}, model(), false, 1);
  // The first is on the ground that its own height is taken for, and left out.
  ASSERT_EQ(frames.rows.size(), 10U);
  EXPECT_EQ(frames.rows[4].height_agl_m, 77);
  EXPECT_NEAR(frames.rows[9].height_agl_m, 130, 1e-9);
  EXPECT_EQ(frames.notes[0], "frames left out: 1 without a height above the ground");
  EXPECT_NE(frames.notes[1].find("the ground is taken to lie at 90.0 m above sea level"), std::string::npos);
}

TEST(LogFrames, WithoutCapturesFramesAreMadeUpOnlyToBeRendered) {
  LogFrameOptions options;
  options.ground_amsl_m = 100;
  options.every_s = 2.5;
  EXPECT_EQ(frames_of_log(northward(false), options, model(), true, 1).rows.size(), 5U);
  EXPECT_THROW(frames_of_log(northward(false), options, model(), false, 1), DataError);
}

TEST(LogFrames, WhatIsMissingIsSaid) {
  VehicleLog log = northward(true);
  log.estimate.attitudes.clear();
  EXPECT_THROW(frames_of_log(log, {}, model(), false, 1), DataError) << "no attitude";
  log = northward(true);
  log.truth.positions.clear();
  LogFrameOptions options;
  options.ground_amsl_m = 100;
  EXPECT_THROW(frames_of_log(log, options, model(), false, 1), DataError) << "no truth to draw priors from";
  log.gnss.positions.push_back({0, {16.5, 55.5}, 220});
  log.gnss.positions.push_back({10, {16.5, 55.501}, 220});
  EXPECT_THROW(frames_of_log(log, options, model(), false, 1), DataError) << "GNSS 5 s away at the middle";
}

}  // namespace
}  // namespace pilotage
