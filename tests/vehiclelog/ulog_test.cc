#include "vehiclelog/log_writers.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/vehiclelog/ulog_format.h"
#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {
namespace {

TEST(Ulog, SmallLogIsReadBack) {
  const VehicleLog log = parse_flight(small_ulog());
  EXPECT_EQ(log.format, LogFormat::kUlog);
  ASSERT_EQ(log.estimate.positions.size(), 10U);
  EXPECT_EQ(log.estimate.positions[3].time_s, 4);
  EXPECT_EQ(log.estimate.positions[3].point.lat_deg, 55.5);
  EXPECT_EQ(log.estimate.positions[3].point.lon_deg, 16.5 + 4e-4);
  EXPECT_EQ(log.estimate.positions[3].amsl_m, 220);
  ASSERT_EQ(log.estimate.attitudes.size(), 10U);
  EXPECT_NEAR(log.estimate.attitudes[0].attitude.yaw_deg, 90, 1e-4);
  ASSERT_EQ(log.captures.size(), 5U);
  EXPECT_EQ(log.captures[1].time_s, 4.5);
  EXPECT_EQ(log.captures[1].number, 2);
  EXPECT_EQ(log.captures[1].agl_m, 120);
  EXPECT_EQ(log.losses.bytes_skipped, 0);
  EXPECT_FALSE(log.losses.truncated);
}

TEST(UlogFormats, FieldsLieBehindNestedOnesArraysAndPadding) {
  UlogFormats formats;
  EXPECT_TRUE(formats.add("outer:uint64_t timestamp;inner[3] parts;uint8_t[2] _padding0;int16_t last;"));
  EXPECT_TRUE(formats.add("inner:float[2] pair;bool flag;char[5] name;"));
  const auto last = formats.find("outer", "last");
  ASSERT_TRUE(last);
  EXPECT_EQ(last->offset, 8U + 3 * (8 + 1 + 5) + 2);
  const auto flag = formats.find("outer", "parts.flag");
  ASSERT_TRUE(flag);
  EXPECT_EQ(flag->offset, 16U);
  EXPECT_FALSE(formats.find("outer", "parts"));
  EXPECT_FALSE(formats.find("outer", "nothing"));
}

TEST(UlogFormats, WhatHasNoSizeHasNoPlaces) {
  UlogFormats formats;
  formats.add("a:b[9] x;uint64_t timestamp;");
  formats.add("b:a[9] x;");
  EXPECT_FALSE(formats.find("a", "timestamp"));
  EXPECT_FALSE(formats.add("no colon"));
  EXPECT_FALSE(formats.add("c:float[2 x;"));
  EXPECT_FALSE(formats.add("c:float[] x;"));
  EXPECT_FALSE(formats.add("c:float[99999999999999999999] x;"));
  for (int i = 0; i < 60; ++i) {
    formats.add("deep" + std::to_string(i) + ":deep" + std::to_string(i + 1) + "[1000] x;uint8_t y;");
  }
  EXPECT_FALSE(formats.find("deep0", "y"));
}

// Four bytes of a file would take 72 of memory.
TEST(UlogFormats, FormatsOfMoreFieldsThanAnyLogHasAreLeftOut) {
  UlogFormats formats;
  std::string many = "wide:";
  for (int i = 0; i < 16000; ++i) many += "c x;";
  int taken = 0;
  for (int i = 0; i < 100; ++i) taken += formats.add(many) ? 1 : 0;
  EXPECT_EQ(taken, 12) << "of 16,001 fields, 200,000 in all";
  EXPECT_TRUE(formats.add("small:uint64_t timestamp;"));
  EXPECT_TRUE(formats.find("small", "timestamp"));
}

TEST(UlogFormats, NumbersOfEveryType) {
  const std::string record = LogText()
                                 .i(-2, 1)
                                 .u(254, 1)
                                 .i(-300, 2)
                                 .u(65000, 2)
                                 .i(-70000, 4)
                                 .u(4000000000U, 4)
                                 .i(-5000000000, 8)
                                 .u(5000000000, 8)
                                 .f(0.5)
                                 .d(-0.25)
                                 .u(1, 1)
                                 .str();
  UlogFormats formats;
  formats.add(
      "all:int8_t a;uint8_t b;int16_t c;uint16_t d;int32_t e;uint32_t f;int64_t g;uint64_t h;float i;double j;bool k;");
  const std::map<std::string, double> expected{{"a", -2},
                                               {"b", 254},
                                               {"c", -300},
                                               {"d", 65000},
                                               {"e", -70000},
                                               {"f", 4000000000.0},
                                               {"g", -5000000000.0},
                                               {"h", 5000000000.0},
                                               {"i", 0.5},
                                               {"j", -0.25},
                                               {"k", 1}};
  for (const auto& [field, value] : expected) {
    const auto place = formats.find("all", field);
    ASSERT_TRUE(place) << field;
    EXPECT_EQ(ulog_number(*place, record, 0), value) << field;
    EXPECT_FALSE(ulog_number(*place, record, 1)) << field;
    EXPECT_FALSE(ulog_number(*place, record.substr(0, place->offset), 0)) << field;
  }
}

TEST(Ulog, OfSeveralInstancesTheLowestWithRecordsIsTaken) {
  std::string log = ulog_head() + ulog_format(kPositionFormat) + ulog_stream(0, "vehicle_global_position", 0) +
                    ulog_stream(1, "vehicle_global_position", 1) + ulog_stream(2, "vehicle_global_position", 2);
  log += ulog_record(2, ulog_time(1).d(10).d(20).f(1));
  log += ulog_record(1, ulog_time(1).d(11).d(21).f(1));
  const VehicleLog read = parse_flight(log);
  ASSERT_EQ(read.estimate.positions.size(), 1U);
  EXPECT_EQ(read.estimate.positions[0].point.lat_deg, 11);
  EXPECT_EQ(read.losses.other_sources.at("vehicle_global_position 2"), 1);
}

TEST(Ulog, GnssOfBothAgesAndUtc) {
  const std::string old_format = ulog_format(
      "vehicle_gps_position:uint64_t timestamp;uint64_t time_utc_usec;int32_t lat;int32_t "
      "lon;int32_t alt;uint8_t fix_type;");
  const std::string new_format = ulog_format(
      "vehicle_gps_position:uint64_t timestamp;double latitude_deg;double longitude_deg;"
      "double altitude_msl_m;uint64_t time_utc_usec;uint8_t fix_type;");
  const std::string stream = ulog_stream(5, "vehicle_gps_position");
  const VehicleLog old_log = parse_flight(
      ulog_head() + old_format + stream +
      ulog_record(5, ulog_time(2).u(1700000000000000, 8).i(555000000, 4).i(-165000000, 4).i(-12000, 4).u(3, 1)) +
      ulog_record(5, ulog_time(3).u(1, 8).i(1, 4).i(1, 4).i(1, 4).u(2, 1)));
  ASSERT_EQ(old_log.gnss.positions.size(), 1U);
  EXPECT_NEAR(old_log.gnss.positions[0].point.lat_deg, 55.5, 1e-9);
  EXPECT_NEAR(old_log.gnss.positions[0].point.lon_deg, -16.5, 1e-9);
  EXPECT_NEAR(old_log.gnss.positions[0].amsl_m, -12, 1e-9);
  ASSERT_TRUE(old_log.utc_minus_log_s);
  EXPECT_NEAR(*old_log.utc_minus_log_s, 1700000000 - 2, 1e-6);
  const VehicleLog new_log =
      parse_flight(ulog_head() + new_format + stream +
                   ulog_record(5, ulog_time(2).d(55.5).d(-16.5).d(-12).u(1700000000000000, 8).u(3, 1)));
  ASSERT_EQ(new_log.gnss.positions.size(), 1U);
  EXPECT_EQ(new_log.gnss.positions[0].point.lat_deg, 55.5);
}

TEST(Ulog, AppendedDataAreReadBehindACutMessage) {
  const std::string head =
      ulog_head() + ulog_flags(0) + ulog_format(kPositionFormat) + ulog_stream(0, "vehicle_global_position");
  const std::string first = ulog_record(0, ulog_time(1).d(10).d(20).f(1));
  const std::string cut_message = first.substr(0, 9);
  const std::string whole = head + first + cut_message;
  const std::string flags = ulog_flags(whole.size());
  const std::string log = ulog_head() + flags + whole.substr(ulog_head().size() + flags.size()) +
                          ulog_record(0, ulog_time(2).d(11).d(20).f(1));
  const VehicleLog read = parse_flight(log);
  ASSERT_EQ(read.estimate.positions.size(), 2U);
  EXPECT_EQ(read.estimate.positions[1].point.lat_deg, 11);
  EXPECT_EQ(read.losses.bytes_skipped, 9);
}

TEST(Ulog, UnknownIncompatibleFlagIsAnError) {
  std::string log = small_ulog();
  log[ulog_head().size() + 3 + 8] = 2;
  EXPECT_THROW(parse_flight(log), DataError);
}

TEST(Ulog, GroundTruthIsKeptApart) {
  const std::string log =
      ulog_head() +
      ulog_format("vehicle_global_position_groundtruth:uint64_t timestamp;double lat;double lon;float alt;") +
      ulog_format("vehicle_attitude_groundtruth:uint64_t timestamp;float[4] q;") +
      ulog_stream(0, "vehicle_global_position_groundtruth") + ulog_stream(1, "vehicle_attitude_groundtruth") +
      ulog_record(0, ulog_time(1).d(10).d(20).f(1)) + ulog_record(1, ulog_attitude_record(1, -30));
  const VehicleLog read = parse_flight(log);
  EXPECT_TRUE(read.estimate.positions.empty());
  EXPECT_EQ(read.truth.positions.size(), 1U);
  ASSERT_EQ(read.truth.attitudes.size(), 1U);
  EXPECT_NEAR(read.truth.attitudes[0].attitude.yaw_deg, -30, 1e-4);
}

TEST(Ulog, ARangeCountsByItsSignalItsReachAndItsSensor) {
  const auto sensor = [](double time_s, double distance_m, double largest_m, int quality, int orientation) {
    return ulog_time(time_s).f(0.2).f(largest_m).f(distance_m).i(quality, 1).u(orientation, 1);
  };
  std::string log =
      ulog_head() +
      ulog_format(
          "distance_sensor:uint64_t timestamp;float min_distance;float max_distance;float current_distance;"
          "int8_t signal_quality;uint8_t orientation;") +
      ulog_format(kPositionFormat) + ulog_stream(0, "distance_sensor", 0) + ulog_stream(1, "distance_sensor", 1) +
      ulog_stream(2, "vehicle_global_position") + ulog_record(2, ulog_time(1).d(55).d(16).f(1));
  log += ulog_record(0, sensor(1, 6.9, 7, 100, 25));  // one reading: the other sensor has more
  log += ulog_record(1, sensor(1, 60, 120, 100, 25)) + ulog_record(1, sensor(2, 61, 120, -1, 25));
  log += ulog_record(1, sensor(3, 8, 120, 0, 25)) + ulog_record(1, sensor(4, 120, 120, 100, 25));
  log += ulog_record(1, sensor(5, 9, 120, 100, 0));
  const VehicleLog read = parse_flight(log);
  ASSERT_EQ(read.ranges.size(), 2U);
  EXPECT_NEAR(read.ranges[1].agl_m, 61, 1e-5);
  EXPECT_EQ(read.losses.ranges_left_out, 2);
  EXPECT_EQ(read.losses.other_sources.at("distance_sensor 0"), 1);
}

TEST(Ulog, LocalPositionNeedsItsReference) {
  const std::string head =
      ulog_head() +
      ulog_format(
          "vehicle_local_position:uint64_t timestamp;double ref_lat;double ref_lon;float x;float y;"
          "float z;float ref_alt;float vx;float vy;float vz;bool xy_global;") +
      ulog_stream(0, "vehicle_local_position");
  const auto record = [](double time_s, int global) {
    return ulog_record(0, ulog_time(time_s).d(55.5).d(16.5).f(1000).f(0).f(-100).f(50).f(1).f(2).f(3).u(global, 1));
  };
  const VehicleLog log = parse_flight(head + record(1, 0) + record(2, 1));
  ASSERT_EQ(log.estimate.velocities.size(), 2U);
  EXPECT_EQ(log.estimate.velocities[0].east_mps, 2);
  ASSERT_EQ(log.estimate.positions.size(), 1U);
  // 1° of latitude is 111,333 m here (a(1−e²)/(1−e² sin²φ)^1.5 · π/180).
  EXPECT_NEAR(log.estimate.positions[0].point.lat_deg, 55.5 + 1000 / 111333.0, 1e-6);
  EXPECT_EQ(log.estimate.positions[0].amsl_m, 150);
}

TEST(Ulog, DamageInTheMiddleCostsWhatLiesBeforeTheNextMark) {
  std::string log = small_ulog();
  const std::size_t at = log.find(ulog_sync(), log.size() / 2) + ulog_sync().size();
  log[at + 2] = '?';
  const VehicleLog read = parse_flight(log);
  EXPECT_GT(read.losses.bytes_skipped, 0);
  EXPECT_EQ(read.estimate.positions.size(), 9U);
  EXPECT_EQ(read.estimate.attitudes.size(), 9U);
}

TEST(Ulog, CutAtEveryByteIsAnErrorOrAStatedLoss) {
  const std::string log = small_ulog();
  for (std::size_t size = 0; size < log.size(); ++size) {
    try {
      const VehicleLog read = parse_flight(log.substr(0, size));
      EXPECT_LE(read.estimate.positions.size(), 10U);
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find("flight"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace pilotage
