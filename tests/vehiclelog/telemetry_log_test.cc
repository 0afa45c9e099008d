#include <algorithm>
#include <cmath>

#include "vehiclelog/log_writers.h"
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/vehiclelog/mavlink_frame.h"
#include "pilotage/vehiclelog/vehicle_log.h"

namespace pilotage {
namespace {

using Sources = std::map<std::string, std::int64_t>;

std::string level(double yaw_rad) {
  return LogText().u(1000, 4).f(0).f(0).f(yaw_rad).f(0).f(0).f(0).str();
}

std::string at_origin_of(int degree) {
  return LogText()
      .u(1000, 4)
      .i(degree * 10000000LL, 4)
      .i(degree * 10000000LL, 4)
      .i(1, 4)
      .i(1, 4)
      .i(0, 2)
      .i(0, 2)
      .i(0, 2)
      .u(0, 2)
      .str();
}

std::string heartbeat(unsigned type, unsigned autopilot) {
  return LogText().u(0, 4).u(type, 1).u(autopilot, 1).u(0, 1).u(0, 1).u(3, 1).str();
}

TEST(Telemetry, SmallLogIsReadBack) {
  const VehicleLog log = parse_flight(small_telemetry());
  EXPECT_EQ(log.format, LogFormat::kTelemetry);
  ASSERT_EQ(log.estimate.positions.size(), 10U);
  EXPECT_NEAR(log.estimate.positions[0].point.lat_deg, 55.5, 1e-9);
  EXPECT_NEAR(log.estimate.positions[0].time_s, 1.7e9 + 1, 1e-6);
  EXPECT_EQ(log.estimate.positions[0].amsl_m, 220);
  EXPECT_NEAR(log.estimate.velocities[0].east_mps, 6.3, 1e-9);
  ASSERT_EQ(log.estimate.attitudes.size(), 10U);
  EXPECT_NEAR(log.estimate.attitudes[0].attitude.yaw_deg, 90, 1e-5);
  EXPECT_NEAR(log.estimate.attitudes[0].attitude.pitch_deg, 0.2 * 57.29578, 1e-5);
  EXPECT_NEAR(log.estimate.attitudes[0].attitude.roll_deg, -0.1 * 57.29578, 1e-5);
  ASSERT_EQ(log.captures.size(), 5U);
  EXPECT_EQ(log.captures[2].number, 3);
  EXPECT_EQ(log.losses.bytes_skipped, 0);
  EXPECT_EQ(log.utc_minus_log_s, 0.0);
}

/// How MAVLink derives the seed from the name and the fields of a message, in the order of the wire.
std::uint8_t crc_extra(const std::string& name, const std::string& fields, std::uint8_t array_length_of_q = 0) {
  std::uint16_t crc = mavlink_crc(name + " ");
  std::size_t at = 0;
  while (at < fields.size()) {
    const std::size_t end = std::min(fields.find(',', at), fields.size());
    const std::string field = fields.substr(at, end - at);
    crc = mavlink_crc(field + " ", crc);
    const char length = field.ends_with(" q") ? static_cast<char>(array_length_of_q)
                                              : static_cast<char>(field.ends_with(" file_url") ? 205 : 0);
    if (length != 0) crc = mavlink_crc({&length, 1}, crc);
    at = end + 1;
  }
  return static_cast<std::uint8_t>((crc & 0xFF) ^ (crc >> 8));
}

TEST(Mavlink, SeedsAreThoseOfTheMessages) {
  EXPECT_EQ(mavlink_crc("123456789"), 0x6F91);  // CRC-16/MCRF4XX's check value
  const auto seed = [](std::uint32_t id) { return mavlink_crc_extra(id).value_or(0); };
  EXPECT_EQ(seed(0), crc_extra("HEARTBEAT",
                               "uint32_t custom_mode,uint8_t type,uint8_t autopilot,uint8_t base_mode,uint8_t "
                               "system_status,uint8_t mavlink_version"));
  EXPECT_EQ(seed(24), crc_extra("GPS_RAW_INT",
                                "uint64_t time_usec,int32_t lat,int32_t lon,int32_t alt,uint16_t eph,uint16_t "
                                "epv,uint16_t vel,uint16_t cog,uint8_t fix_type,uint8_t satellites_visible"));
  EXPECT_EQ(seed(30), crc_extra("ATTITUDE",
                                "uint32_t time_boot_ms,float roll,float pitch,float yaw,float rollspeed,float "
                                "pitchspeed,float yawspeed"));
  EXPECT_EQ(seed(32), crc_extra("LOCAL_POSITION_NED",
                                "uint32_t time_boot_ms,float x,float y,float z,float vx,float vy,float vz"));
  EXPECT_EQ(seed(33), crc_extra("GLOBAL_POSITION_INT",
                                "uint32_t time_boot_ms,int32_t lat,int32_t lon,int32_t alt,int32_t "
                                "relative_alt,int16_t vx,int16_t vy,int16_t vz,uint16_t hdg"));
  EXPECT_EQ(seed(112), crc_extra("CAMERA_TRIGGER", "uint64_t time_usec,uint32_t seq"));
  EXPECT_EQ(seed(132), crc_extra("DISTANCE_SENSOR",
                                 "uint32_t time_boot_ms,uint16_t min_distance,uint16_t max_distance,uint16_t "
                                 "current_distance,uint8_t type,uint8_t id,uint8_t orientation,uint8_t covariance"));
  EXPECT_EQ(
      seed(180),
      crc_extra("CAMERA_FEEDBACK",
                "uint64_t time_usec,int32_t lat,int32_t lng,float alt_msl,float alt_rel,float roll,float "
                "pitch,float yaw,float foc_len,uint16_t img_idx,uint8_t target_system,uint8_t cam_idx,uint8_t flags"));
  EXPECT_EQ(seed(263),
            crc_extra("CAMERA_IMAGE_CAPTURED",
                      "uint64_t time_utc,uint32_t time_boot_ms,int32_t lat,int32_t lon,int32_t alt,int32_t "
                      "relative_alt,float q,int32_t image_index,uint8_t camera_id,int8_t capture_result,char file_url",
                      4));
}

TEST(Telemetry, MessagesWithPicturesAndGnss) {
  const std::string gnss = LogText()
                               .u(1, 8)
                               .i(555000000, 4)
                               .i(165000000, 4)
                               .i(90000, 4)
                               .u(1, 2)
                               .u(1, 2)
                               .u(2000, 2)
                               .u(18000, 2)
                               .u(3, 1)
                               .u(9, 1)
                               .str();
  const std::string feedback =
      LogText().u(1, 8).i(555000000, 4).i(165000000, 4).f(220).f(120).f(1).f(2).f(3).f(4).u(17, 2).u(0, 3).str();
  const std::string captured = LogText()
                                   .u(1, 8)
                                   .u(1, 4)
                                   .i(555000000, 4)
                                   .i(165000000, 4)
                                   .i(220000, 4)
                                   .i(120000, 4)
                                   .f(1)
                                   .f(0)
                                   .f(0)
                                   .f(0)
                                   .i(4, 4)
                                   .u(1, 1)
                                   .i(1, 1)
                                   .text("", 205)
                                   .str();
  const std::string distance = LogText().u(1, 4).u(20, 2).u(5000, 2).u(1234, 2).u(0, 1).u(0, 1).u(25, 1).u(0, 1).str();
  for (const int version : {1, 2}) {
    std::string log = telemetry_record(version, 100, 24, gnss, 24) + telemetry_record(version, 101, 132, distance, 85) +
                      telemetry_record(version, 102, 180, feedback, 52);
    if (version == 2) log += telemetry_record(2, 103, 263, captured, 133);
    const VehicleLog read = parse_flight(log);
    ASSERT_EQ(read.gnss.positions.size(), 1U);
    EXPECT_EQ(read.gnss.positions[0].amsl_m, 90);
    ASSERT_EQ(read.gnss.velocities.size(), 1U);
    EXPECT_NEAR(read.gnss.velocities[0].north_mps, -20, 1e-9);
    ASSERT_EQ(read.ranges.size(), 1U);
    EXPECT_NEAR(read.ranges[0].agl_m, 12.34, 1e-9);
    ASSERT_EQ(read.captures.size(), 1U) << "feedback says more than captured";
    EXPECT_EQ(read.captures[0].number, 17);
    EXPECT_EQ(read.captures[0].attitude->yaw_deg, 3);
  }
  const VehicleLog alone = parse_flight(telemetry_record(2, 103, 263, captured, 133));
  ASSERT_EQ(alone.captures.size(), 1U);
  EXPECT_EQ(alone.captures[0].number, 4);
  EXPECT_EQ(alone.captures[0].amsl_m, 220);
}

TEST(Telemetry, OtherAircraftAreLeftOut) {
  const std::string position =
      LogText().u(1000, 4).i(1, 4).i(1, 4).i(1, 4).i(1, 4).i(0, 2).i(0, 2).i(0, 2).u(0, 2).str();
  const VehicleLog log = parse_flight(small_telemetry() + telemetry_record(2, 1.7e9 + 11, 33, position, 104, 9));
  EXPECT_EQ(log.estimate.positions.size(), 10U);
  EXPECT_EQ(log.losses.other_sources, (Sources{{"system 9, component 1 (autopilot)", 1}}));
}

TEST(Telemetry, AGimbalsAttitudeAndACompanionsPositionAreNotTheAircrafts) {
  std::string log;
  for (int second = 1; second <= 20; ++second) {
    log += telemetry_record(2, 1.7e9 + second, 30, level(0), 39, 1, 154);
    log += telemetry_record(2, 1.7e9 + second, 33, at_origin_of(10), 104, 1, 191);
    log += telemetry_record(2, 1.7e9 + second, 0, heartbeat(26, 8), 50, 1, 154);
    log += telemetry_record(2, 1.7e9 + second, 0, heartbeat(18, 8), 50, 1, 191);
  }
  const VehicleLog read = parse_flight(log + small_telemetry());
  ASSERT_EQ(read.estimate.attitudes.size(), 10U);
  EXPECT_NEAR(read.estimate.attitudes[0].attitude.yaw_deg, 90, 1e-5);
  ASSERT_EQ(read.estimate.positions.size(), 10U);
  EXPECT_NEAR(read.estimate.positions[0].point.lat_deg, 55.5, 1e-9);
  EXPECT_EQ(read.losses.other_sources,
            (Sources{{"system 1, component 154 (gimbal)", 20}, {"system 1, component 191 (companion computer)", 20}}));
}

TEST(Telemetry, TheAutopilotIsWhoseHeartbeatSaysSo) {
  // A ground station comes first, an antenna tracker with an autopilot of its own says most, and the aircraft's
  // autopilot has a number of its own.
  std::string log = telemetry_record(2, 1.7e9, 30, level(1), 39, 255, 190);
  for (int i = 0; i < 9; ++i) {
    log += telemetry_record(2, 1.7e9 + i, 0, heartbeat(5, 3), 50, 2, 1);
    log += telemetry_record(2, 1.7e9 + i, 30, level(2), 39, 2, 1);
    log += telemetry_record(2, 1.7e9 + i, 30, level(3), 39, 3, 1);
    log += telemetry_record(2, 1.7e9 + i, 0, heartbeat(6, 8), 50, 255, 190);
  }
  log += telemetry_record(2, 1.7e9 + 9, 0, heartbeat(2, 12), 50, 4, 7);
  log += telemetry_record(2, 1.7e9 + 9, 30, level(1.5), 39, 4, 7);
  const VehicleLog read = parse_flight(log);
  ASSERT_EQ(read.estimate.attitudes.size(), 1U);
  EXPECT_NEAR(read.estimate.attitudes[0].attitude.yaw_deg, 1.5 * 57.29578, 1e-4);
  EXPECT_EQ(read.losses.other_sources.at("system 2, component 1 (autopilot)"), 9);
}

TEST(Telemetry, PicturesAreOfTheAircraftsOneCamera) {
  const auto trigger = [](int number) { return LogText().u(1, 8).u(number, 4).str(); };
  std::string log = small_telemetry();
  for (int i = 0; i < 3; ++i) {
    log += telemetry_record(2, 1.7e9 + 11 + i, 112, trigger(100 + i), 174, 1, 101);  // another camera, fewer pictures
    log += telemetry_record(2, 1.7e9 + 11 + i, 112, trigger(200 + i), 174, 7, 1);    // another aircraft
  }
  const VehicleLog read = parse_flight(log);
  ASSERT_EQ(read.captures.size(), 5U);
  EXPECT_EQ(read.captures[4].number, 5);
  EXPECT_EQ(read.losses.other_sources.at("system 1, component 101 (camera)"), 3);
}

TEST(Telemetry, ARangeCountsByItsSignalItsReachAndItsSensor) {
  const auto distance = [](double time_s, int distance_cm, int largest_cm, int sensor, int quality,
                           int orientation = 25) {
    return telemetry_record(2, time_s, 132,
                            LogText()
                                .u(1, 4)
                                .u(20, 2)
                                .u(largest_cm, 2)
                                .u(distance_cm, 2)
                                .u(0, 1)
                                .u(sensor, 1)
                                .u(orientation, 1)
                                .u(0, 1)
                                .u(0, 24)
                                .u(quality, 1)
                                .str(),
                            85);
  };
  std::string log = small_telemetry();  // its last attitude is at second 10
  const double begin_s = 1.7e9 + 10;
  for (int i = 1; i <= 4; ++i) log += distance(begin_s + 0.1 * i, 6000 + i, 12000, 0, 100);
  for (int i = 1; i <= 3; ++i) log += distance(begin_s + 0.4 + 0.01 * i, 650, 700, 1, 0);  // fewer: a sonar
  log += distance(begin_s + 0.5, 800, 12000, 0, 1);                                        // no signal
  log += distance(begin_s + 0.6, 12000, 12000, 0, 100);                                    // its largest range
  log += distance(begin_s + 0.7, 6000, 0, 0, 0);          // knows neither its quality nor its range
  log += distance(begin_s + 0.8, 500, 12000, 2, 100, 0);  // looks ahead
  const VehicleLog read = parse_flight(log);
  ASSERT_EQ(read.ranges.size(), 5U);
  // Pitch 0.2 rad, roll −0.1 rad: the beam is longer than the height.
  EXPECT_NEAR(read.ranges[0].agl_m, 60.01 * std::cos(0.2) * std::cos(0.1), 1e-6);
  EXPECT_NEAR(read.ranges[4].agl_m, 60 * std::cos(0.2) * std::cos(0.1), 1e-6);
  EXPECT_EQ(read.losses.ranges_left_out, 2);
  EXPECT_EQ(read.losses.other_sources.at("range finder 1 of system 1, component 1 (autopilot)"), 3);
}

TEST(Telemetry, ABeamThatIsTiltedTooFarSaysNoHeight) {
  const std::string steep = LogText().u(1000, 4).f(1).f(0).f(1).f(0).f(0).f(0).str();  // 57° of roll
  const std::string distance = LogText().u(1, 4).u(20, 2).u(9000, 2).u(6000, 2).u(0, 1).u(0, 1).u(25, 1).u(0, 1).str();
  const VehicleLog read =
      parse_flight(telemetry_record(2, 100, 30, steep, 39) + telemetry_record(2, 100, 132, distance, 85));
  EXPECT_TRUE(read.ranges.empty());
  EXPECT_EQ(read.losses.ranges_left_out, 1);
}

TEST(Telemetry, WrongChecksumIsCountedAndTheNextFrameFound) {
  std::string log = small_telemetry();
  log[8 + 10 + 4] = static_cast<char>(log[8 + 10 + 4] ^ 1);  // in the payload of the first record
  EXPECT_THROW(parse_flight(log), DataError) << "a log must begin with a sound record";
  std::string later = small_telemetry();
  const std::size_t half = later.find(telemetry_record(
      2, 1.7e9 + 5, 30, LogText().u(1000, 4).f(-0.1).f(0.2).f(3.14159265358979 / 2).f(0).f(0).f(0).str(), 39));
  ASSERT_NE(half, std::string::npos);
  later[half + 8 + 10 + 4] = static_cast<char>(later[half + 8 + 10 + 4] ^ 1);
  const VehicleLog read = parse_flight(later);
  EXPECT_EQ(read.losses.bad_checksums, 1);
  EXPECT_EQ(read.estimate.attitudes.size(), 9U);
  EXPECT_EQ(read.estimate.positions.size(), 10U);
}

TEST(Telemetry, SignedFramesAreLonger) {
  std::string record = telemetry_record(2, 1.7e9, 30, LogText().u(1000, 4).f(0).f(0).f(1).f(0).f(0).f(0).str(), 39);
  std::string body = record.substr(9, record.size() - 11);
  body[1] = 1;
  const char extra = 39;
  const std::uint16_t crc = mavlink_crc({&extra, 1}, mavlink_crc(body));
  const std::string signed_record = record.substr(0, 9) + body + LogText().u(crc, 2).str() + std::string(13, 's');
  const VehicleLog read = parse_flight(signed_record + signed_record);
  EXPECT_EQ(read.estimate.attitudes.size(), 2U);
  EXPECT_EQ(read.losses.bytes_skipped, 0);
}

TEST(Telemetry, CutAtEveryByteIsAnErrorOrAStatedLoss) {
  const std::string log = small_telemetry();
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
