#include <cmath>

#include "vehiclelog/log_writers.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {
namespace {

std::string format_of_formats() {
  return dataflash_format(128, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
}

TEST(DataFlash, SmallLogIsReadBack) {
  const VehicleLog log = parse_flight(small_dataflash());
  EXPECT_EQ(log.format, LogFormat::kDataFlash);
  ASSERT_EQ(log.estimate.positions.size(), 10U);
  EXPECT_NEAR(log.estimate.positions[9].point.lon_deg, 16.501, 1e-9);
  ASSERT_EQ(log.estimate.attitudes.size(), 10U);
  EXPECT_NEAR(log.estimate.attitudes[0].attitude.roll_deg, -1.5, 1e-9);
  EXPECT_NEAR(log.estimate.attitudes[0].attitude.pitch_deg, 2, 1e-9);
  EXPECT_NEAR(log.estimate.attitudes[0].attitude.yaw_deg, 90, 1e-9);
  ASSERT_EQ(log.captures.size(), 5U);
  EXPECT_EQ(log.captures[4].number, 5);
  EXPECT_EQ(log.captures[4].time_s, 10.5);
  EXPECT_NEAR(log.captures[4].amsl_m, 220, 1e-9);
  ASSERT_TRUE(log.captures[4].attitude);
  EXPECT_NEAR(log.captures[4].attitude->roll_deg, -1.5, 1e-6);
  EXPECT_EQ(log.losses.bytes_skipped, 0);
}

/// The yaw of a record of ATT that has it in `letter`.
double yaw_in(char letter, const LogText& yaw) {
  const std::string log = format_of_formats() +
                          dataflash_format(20, "ATT", std::string("Q") + letter + "ff", "TimeUS,Yaw,Pitch,Roll") +
                          dataflash_record(20, LogText().u(1000000, 8).text(yaw.str()).f(0).f(0));
  return parse_flight(log).estimate.attitudes.at(0).attitude.yaw_deg;
}

TEST(DataFlash, NumbersOfEveryKind) {
  EXPECT_EQ(yaw_in('b', LogText().i(-5, 1)), -5);
  EXPECT_EQ(yaw_in('B', LogText().u(200, 1)), 200);
  EXPECT_EQ(yaw_in('M', LogText().u(7, 1)), 7);
  EXPECT_EQ(yaw_in('h', LogText().i(-170, 2)), -170);
  EXPECT_EQ(yaw_in('H', LogText().u(350, 2)), 350);
  EXPECT_EQ(yaw_in('i', LogText().i(-123, 4)), -123);
  EXPECT_EQ(yaw_in('I', LogText().u(321, 4)), 321);
  EXPECT_EQ(yaw_in('q', LogText().i(-33, 8)), -33);
  EXPECT_EQ(yaw_in('Q', LogText().u(33, 8)), 33);
  EXPECT_EQ(yaw_in('f', LogText().f(1.25)), 1.25);
  EXPECT_EQ(yaw_in('d', LogText().d(-1.2)), -1.2);
  EXPECT_EQ(yaw_in('g', LogText().u(0xC900, 2)), -10);  // −1.25 · 2³ in half precision
  EXPECT_EQ(yaw_in('g', LogText().u(0x0001, 2)), std::ldexp(1.0, -24));
  EXPECT_NEAR(yaw_in('c', LogText().i(-1234, 2)), -12.34, 1e-12);
  EXPECT_NEAR(yaw_in('C', LogText().u(35999, 2)), 359.99, 1e-12);
  EXPECT_NEAR(yaw_in('e', LogText().i(-1234, 4)), -12.34, 1e-12);
  EXPECT_NEAR(yaw_in('E', LogText().u(1234, 4)), 12.34, 1e-12);
  EXPECT_NEAR(yaw_in('L', LogText().i(-1234567890, 4)), -123.456789, 1e-9);
}

TEST(DataFlash, TextsAndArraysTakeTheirPlace) {
  const std::string log =
      format_of_formats() + dataflash_format(20, "ATT", "QanZNfff", "TimeUS,Array,Four,Long,Name,Yaw,Pitch,Roll") +
      dataflash_record(
          20, LogText().u(1000000, 8).text("", 64).text("abcd").text("long", 64).text("name", 16).f(1).f(2).f(3));
  // 3 + 8 + 64 + 4 + 64 + 16 + 12 = 171 bytes
  const VehicleLog read = parse_flight(log);
  ASSERT_EQ(read.estimate.attitudes.size(), 1U);
  EXPECT_EQ(read.estimate.attitudes[0].attitude.roll_deg, 3);
}

TEST(DataFlash, FormatThatDoesNotFillItsSizeIsDamage) {
  std::string format = dataflash_format(20, "ATT", "Qfff", "TimeUS,Yaw,Pitch,Roll");
  format[4] = 30;  // the size, really 23
  EXPECT_THROW(
      parse_flight(format_of_formats() + format + dataflash_record(20, LogText().u(1000000, 8).f(1).f(2).f(3))),
      DataError);
}

TEST(DataFlash, FurtherReceiversAndFiltersAreLeftOut) {
  std::string log =
      format_of_formats() + dataflash_format(21, "GPS", "QBBIHLLfff", "TimeUS,I,Status,GMS,GWk,Lat,Lng,Alt,Spd,GCrs");
  const auto record = [](int instance, int status) {
    return dataflash_record(21, LogText()
                                    .u(2000000, 8)
                                    .u(instance, 1)
                                    .u(status, 1)
                                    .u(3600000, 4)
                                    .u(2300, 2)
                                    .i(555000000, 4)
                                    .i(165000000, 4)
                                    .f(50)
                                    .f(20)
                                    .f(90));
  };
  log += record(1, 3) + record(0, 1) + record(0, 3);
  const VehicleLog read = parse_flight(log);
  ASSERT_EQ(read.gnss.positions.size(), 1U);
  EXPECT_EQ(read.losses.other_sources.at("GPS 1"), 1);
  ASSERT_EQ(read.gnss.velocities.size(), 1U);
  EXPECT_NEAR(read.gnss.velocities[0].east_mps, 20, 1e-5);
  ASSERT_TRUE(read.utc_minus_log_s);
  // Week 2300 began on 2024-02-04, 1707004800; one hour later, less 18 leap seconds, at second 2 of the log.
  EXPECT_EQ(*read.utc_minus_log_s, 1707004800.0 + 3600 - 18 - 2);
}

TEST(DataFlash, TriggersCountOnlyWithoutPictures) {
  const std::string trigger = dataflash_format(30, "TRIG", "QLLe", "TimeUS,Lat,Lng,Alt") +
                              dataflash_record(30, LogText().u(1000000, 8).i(1, 4).i(1, 4).i(100, 4));
  EXPECT_EQ(parse_flight(format_of_formats() + trigger).captures.size(), 1U);
  EXPECT_EQ(parse_flight(small_dataflash() + trigger).captures.size(), 5U);
}

TEST(DataFlash, ARangeCountsByItsStatusAndItsSensor) {
  const std::string format =
      format_of_formats() + dataflash_format(40, "RFND", "QBfBBb", "TimeUS,Instance,Dist,Stat,Orient,Quality");
  const auto record = [](int second, int instance, double distance_m, int status, int orientation, int quality) {
    return dataflash_record(40, LogText()
                                    .u(static_cast<std::uint64_t>(second) * 1000000, 8)
                                    .u(instance, 1)
                                    .f(distance_m)
                                    .u(status, 1)
                                    .u(orientation, 1)
                                    .i(quality, 1));
  };
  // The first sensor looks ahead; the second, downward, counts where its status is 4 and its signal is not 0.
  const std::string log = small_dataflash() + format + record(10, 0, 15, 4, 0, 100) + record(10, 1, 60, 4, 25, 100) +
                          record(11, 1, 61, 4, 25, -1) + record(12, 1, 8, 3, 25, 100) + record(13, 1, 8, 1, 25, 100) +
                          record(14, 1, 8, 4, 25, 0) + record(15, 2, 30, 4, 25, 90);
  const VehicleLog read = parse_flight(log);
  ASSERT_EQ(read.ranges.size(), 2U);
  // Pitch 2°, roll −1.5°.
  EXPECT_NEAR(read.ranges[0].agl_m, 60 * 0.999391 * 0.999657, 1e-4);
  EXPECT_EQ(read.losses.ranges_left_out, 3);
  EXPECT_EQ(read.losses.other_sources.at("range finder 2"), 1);
}

TEST(DataFlash, TwoSensorsInOneRecordAsOlderVersionsWriteThem) {
  const std::string format =
      format_of_formats() + dataflash_format(40, "RFND", "QCBBCBB", "TimeUS,Dist1,Stat1,Orient1,Dist2,Stat2,Orient2");
  const auto record = [](int second, int first_cm, int first_status, int second_cm) {
    return dataflash_record(40, LogText()
                                    .u(static_cast<std::uint64_t>(second) * 1000000, 8)
                                    .u(first_cm, 2)
                                    .u(first_status, 1)
                                    .u(25, 1)
                                    .u(second_cm, 2)
                                    .u(4, 1)
                                    .u(0, 1));
  };
  const VehicleLog read = parse_flight(small_dataflash() + format + record(20, 6000, 4, 900) + record(21, 700, 2, 900));
  ASSERT_EQ(read.ranges.size(), 1U);
  EXPECT_NEAR(read.ranges[0].agl_m, 60, 1e-9) << "no attitude within 1 s: taken as level";
  EXPECT_EQ(read.losses.ranges_left_out, 1);
  EXPECT_TRUE(read.losses.other_sources.empty());
}

TEST(DataFlash, BytesBetweenRecordsAreSkipped) {
  const VehicleLog log =
      parse_flight(small_dataflash() + "garbage" + dataflash_record(11, LogText().u(11000000, 8).i(1, 4).i(1, 4).f(1)));
  EXPECT_EQ(log.losses.bytes_skipped, 7);
  EXPECT_EQ(log.estimate.positions.size(), 11U);
}

TEST(DataFlash, CutAtEveryByteIsAnErrorOrAStatedLoss) {
  const std::string log = small_dataflash();
  for (std::size_t size = 0; size < log.size(); ++size) {
    try {
      EXPECT_LE(parse_flight(log.substr(0, size)).estimate.positions.size(), 10U);
    } catch (const DataError& error) {
      EXPECT_NE(std::string(error.what()).find("flight"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace pilotage
