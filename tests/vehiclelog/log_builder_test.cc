#include "pilotage/vehiclelog/log_builder.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

void add(LogBuilder& builder, double time_s) {
  if (builder.accept(time_s)) builder.add_position(&VehicleLog::estimate, time_s, 55, 16, time_s);
}

TEST(LogBuilder, OneWrongTimeCostsOneRecord) {
  LogBuilder builder(LogFormat::kUlog);
  for (int i = 0; i < 100; ++i) add(builder, i == 50 ? 1e9 : i);
  const VehicleLog log = builder.finish();
  EXPECT_EQ(log.estimate.positions.size(), 99U);
  EXPECT_EQ(log.losses.bad_times, 1);
  EXPECT_EQ(log.losses.clock_jumps, 0);
}

TEST(LogBuilder, WrongFirstTimeCostsFewRecords) {
  LogBuilder builder(LogFormat::kUlog);
  for (int i = 0; i < 100; ++i) add(builder, i == 0 ? 1e9 : i);
  const VehicleLog log = builder.finish();
  EXPECT_EQ(log.estimate.positions.size(), 99U - (kRecordsThatSetClock - 1));
  EXPECT_EQ(log.losses.clock_jumps, 1);
  EXPECT_EQ(log.losses.records_left_out, 1);
}

TEST(LogBuilder, ClockSetBackLeavesTheLargerPart) {
  LogBuilder builder(LogFormat::kUlog);
  for (int i = 0; i < 30; ++i) add(builder, 1000 + i);
  for (int i = 0; i < 70; ++i) add(builder, i);
  const VehicleLog log = builder.finish();
  EXPECT_EQ(log.losses.clock_jumps, 1);
  EXPECT_EQ(log.losses.records_left_out, 30);
  EXPECT_EQ(log.losses.bad_times, kRecordsThatSetClock - 1);
  ASSERT_EQ(log.estimate.positions.size(), 70U - (kRecordsThatSetClock - 1));
  EXPECT_EQ(log.estimate.positions.back().time_s, 69);
}

TEST(LogBuilder, LongSilenceIsAGap) {
  LogBuilder builder(LogFormat::kUlog);
  for (int i = 0; i < 30; ++i) add(builder, i);
  for (int i = 0; i < 30; ++i) add(builder, 1000 + i);
  const VehicleLog log = builder.finish();
  EXPECT_EQ(log.losses.gaps, 1);
  EXPECT_EQ(log.losses.clock_jumps, 0);
  EXPECT_EQ(log.estimate.positions.size(), 60U - (kRecordsThatSetClock - 1));
}

TEST(LogBuilder, SmallDisorderIsPutInOrder) {
  LogBuilder builder(LogFormat::kUlog);
  for (const double time_s : {1.0, 1.5, 1.2, 2.0}) add(builder, time_s);
  const VehicleLog log = builder.finish();
  ASSERT_EQ(log.estimate.positions.size(), 4U);
  EXPECT_EQ(log.estimate.positions[1].time_s, 1.2);
}

TEST(LogBuilder, WhatCannotBeIsCounted) {
  LogBuilder builder(LogFormat::kUlog);
  EXPECT_FALSE(builder.accept(std::nan("")));
  ASSERT_TRUE(builder.accept(1));
  builder.add_position(&VehicleLog::estimate, 1, 95, 16, 0);
  builder.add_position(&VehicleLog::estimate, 1, 0, 0, 0);
  builder.add_position(&VehicleLog::estimate, 1, std::nan(""), 0, 0);
  builder.add_velocity(&VehicleLog::estimate, 1, std::nan(""), 0, 0);
  builder.add_velocity(&VehicleLog::estimate, 1, 0, 0, std::nan(""));
  builder.add_attitude(&VehicleLog::estimate, 1, {0, std::nan(""), 0});
  builder.add_height(1, -3);
  const VehicleLog log = builder.finish();
  EXPECT_EQ(log.losses.bad_values, 7);
  EXPECT_EQ(log.losses.bad_times, 1);
  EXPECT_TRUE(log.estimate.positions.empty());
  EXPECT_TRUE(log.heights.empty());
}

TEST(CaptureNumber, IsAWholeNumberOrNone) {
  EXPECT_EQ(capture_number(17), 17);
  EXPECT_EQ(capture_number(0x1p53), 9007199254740992);
  for (const double none : {-1.0, 2.5, 1e19, -3.1e38, HUGE_VAL, std::nan("")})
    EXPECT_EQ(capture_number(none), 0) << none;
}

TEST(AttitudeOfQuaternion, NeedsLengthOne) {
  EXPECT_FALSE(attitude_of_quaternion(0, 0, 0, 0));
  EXPECT_FALSE(attitude_of_quaternion(NAN, 0, 0, 1));
  const double half = std::sqrt(0.5);
  const auto up = attitude_of_quaternion(half, 0, half, 0);  // nose straight up
  ASSERT_TRUE(up);
  EXPECT_NEAR(up->pitch_deg, 90, 1e-5);
  const auto right_wing_down = attitude_of_quaternion(half, half, 0, 0);
  ASSERT_TRUE(right_wing_down);
  EXPECT_NEAR(right_wing_down->roll_deg, 90, 1e-9);
}

}  // namespace
}  // namespace pilotage
