#include "pilotage/replay/log_frames.h"

#include <cmath>

#include "raster/raster_maker.h"
#include "testing/temporary_folder.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/text.h"
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

/// From 100 m above the sea, before the first capture.
VehicleLog with_take_off() {
  VehicleLog log = northward(true);
  log.truth.positions.insert(log.truth.positions.begin(), {-1, {16.5, 55.4999}, 100});
  return log;
}

/// The notes of frames whose height is less than the ground's, which `options` says.
std::string heights_by(LogFrameOptions options, const VehicleLog& log, double expected_agl_m) {
  options.priors = LogPriors::kLog;
  const LogFrames frames = frames_of_log(log, options, model(), false, 1);
  for (const FrameRecord& row : frames.rows) EXPECT_NEAR(row.height_agl_m, expected_agl_m, 1e-6);
  return join(frames.notes, "; ");
}

TEST(LogFrames, TheGroundIsTheGivenThePlansModelItsFlatGroundOrTheLowestHeight) {
  const testing::TemporaryFolder folder;
  testing::RasterSpec spec;
  spec.type = GDT_Float32;
  spec.srs = "EPSG:4326";
  spec.place = GeoTransform::north_up(16.4, 55.6, 0.01);
  spec.value = [](int, int, int) { return 150; };
  const std::string model_of_plan = testing::make_raster(folder / "ground.tif", spec);
  LogFrameOptions options;
  EXPECT_NE(heights_by(options, with_take_off(), 120).find("the lowest height of the log"), std::string::npos);
  options.flat_ground_amsl_m = 130;
  EXPECT_NE(heights_by(options, with_take_off(), 90).find("as the plan assumed"), std::string::npos);
  options.elevation = model_of_plan;
  EXPECT_NE(heights_by(options, with_take_off(), 70).find("the elevation model of the plan"), std::string::npos);
  options.elevation = (folder / "gone.tif").string();
  EXPECT_NE(heights_by(options, with_take_off(), 90).find("the plan's elevation model is not used"), std::string::npos);
  options.ground_amsl_m = 140;
  EXPECT_NE(heights_by(options, with_take_off(), 80).find("as given"), std::string::npos);
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
  log.heights.push_back({5, 66});
  log.ranges.push_back({5, 77});
  log.truth.positions[0].amsl_m = 90;
  const LogFrames frames = frames_of_log(log, {}, model(), false, 1);
  // The first is on the ground that its own height is taken for, and left out.
  ASSERT_EQ(frames.rows.size(), 10U);
  EXPECT_EQ(frames.rows[4].height_agl_m, 77);
  EXPECT_NEAR(frames.rows[9].height_agl_m, 130, 1e-9);
  EXPECT_EQ(frames.notes[0], "frames left out: 1 without a height above the ground");
  EXPECT_EQ(frames.notes[1],
            "height above ground of 7 frames: by the ground at 90.0 m above sea level, the lowest height of the log: "
            "give --ground-amsl-m");
  EXPECT_EQ(frames.notes[2], "height above ground of 3 frames: by the range finder");
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
