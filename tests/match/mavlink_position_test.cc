#include "pilotage/match/mavlink_position.h"

#include <cmath>
#include <limits>
#include <type_traits>

#include "match/some_fix.h"
#include <gtest/gtest.h>

namespace pilotage {
namespace {

constexpr std::int32_t kInvalid = std::numeric_limits<std::int32_t>::max();

// The definition, field by field: <field type= name= units=> of GLOBAL_POSITION_SENSOR in common.xml.
TEST(MavlinkPosition, FieldsAreThoseOfTheDefinition) {
  using Message = MavlinkGlobalPositionSensor;
  static_assert(std::is_same_v<decltype(Message::target_system), std::uint8_t>);
  static_assert(std::is_same_v<decltype(Message::target_component), std::uint8_t>);
  static_assert(std::is_same_v<decltype(Message::id), std::uint8_t>);
  static_assert(std::is_same_v<decltype(Message::time_usec), std::uint64_t>);
  static_assert(std::is_same_v<decltype(Message::processing_time), std::uint32_t>);
  static_assert(std::is_same_v<std::underlying_type_t<decltype(Message::source)>, std::uint8_t>);
  static_assert(std::is_same_v<decltype(Message::flags), std::uint8_t>);
  static_assert(std::is_same_v<decltype(Message::lat), std::int32_t>);
  static_assert(std::is_same_v<decltype(Message::lon), std::int32_t>);
  static_assert(std::is_same_v<decltype(Message::alt_ellipsoid), float>);
  static_assert(std::is_same_v<decltype(Message::alt), float>);
  static_assert(std::is_same_v<decltype(Message::eph), float>);
  static_assert(std::is_same_v<decltype(Message::epv), float>);
  EXPECT_EQ(kMavlinkGlobalPositionSensorId, 296U);
  EXPECT_EQ(static_cast<int>(MavlinkPositionSource::kVision), 2);
  EXPECT_EQ(kMavlinkPositionUnhealthy, 1);
  EXPECT_EQ(kMavlinkPositionPrimary, 2);
}

TEST(MavlinkPosition, TellsOfAFix) {
  const MatchResult match = testing::some_match();
  const FixAltitude altitude = altitude_over(*match.fix, 55.25, 20.5, 4);
  const auto message = mavlink_global_position_sensor(match, altitude, {1, 190, 7, 1'000'000, 1'045'000});
  EXPECT_EQ(message.target_system, 1);
  EXPECT_EQ(message.target_component, 190);
  EXPECT_EQ(message.id, 7);
  EXPECT_EQ(message.time_usec, 1'045'000U);
  EXPECT_EQ(message.processing_time, 45'000U);
  EXPECT_EQ(message.source, MavlinkPositionSource::kVision);
  EXPECT_EQ(message.flags, 0);
  EXPECT_EQ(message.lat, -10745679);
  EXPECT_EQ(message.lon, 1148741235);
  EXPECT_FLOAT_EQ(message.alt_ellipsoid, 175.25F);
  EXPECT_FLOAT_EQ(message.alt, 140.5F);
  EXPECT_FLOAT_EQ(message.eph, 4.0F);  // the longer axis, not the root of east's or north's variance
  EXPECT_FLOAT_EQ(message.epv, 5.0F);  // 4 m of the ground and 3 m of the height above it
}

TEST(MavlinkPosition, RoundsToTheNearestUnit) {
  MatchResult match = testing::some_match();
  const auto lat_lon = [&](double lat_deg, double lon_deg) {
    match.fix->position = {lon_deg, lat_deg};
    const auto message = mavlink_global_position_sensor(match, {}, {});
    return std::pair(message.lat, message.lon);
  };
  EXPECT_EQ(lat_lon(10.00000004, -10.00000004), std::pair(100000000, -100000000));
  EXPECT_EQ(lat_lon(10.00000006, -10.00000006), std::pair(100000001, -100000001));
  EXPECT_EQ(lat_lon(90, 0), std::pair(900000000, 0));
  EXPECT_EQ(lat_lon(-90, 0), std::pair(-900000000, 0));
  // Longitudes are in [-180, 180), before and after rounding.
  EXPECT_EQ(lat_lon(0, 180), std::pair(0, -1800000000));
  EXPECT_EQ(lat_lon(0, -180), std::pair(0, -1800000000));
  EXPECT_EQ(lat_lon(0, 179.9999999), std::pair(0, 1799999999));
  EXPECT_EQ(lat_lon(0, 179.99999999), std::pair(0, -1800000000));
  EXPECT_EQ(lat_lon(0, 180.5), std::pair(0, -1795000000));
}

TEST(MavlinkPosition, UnknownAltitudeIsNan) {
  const MatchResult match = testing::some_match();
  const auto none = mavlink_global_position_sensor(match, {}, {});
  EXPECT_EQ(none.flags, 0);
  EXPECT_TRUE(std::isnan(none.alt_ellipsoid) && std::isnan(none.alt) && std::isnan(none.epv));
  const double nan = std::nan("");
  const auto amsl = mavlink_global_position_sensor(match, altitude_over(*match.fix, nan, 30, 0), {});
  EXPECT_TRUE(std::isnan(amsl.alt_ellipsoid));
  EXPECT_FLOAT_EQ(amsl.alt, 150.0F);
  EXPECT_FLOAT_EQ(amsl.epv, 3.0F);
  const auto sigma_alone = mavlink_global_position_sensor(match, {nan, nan, 5}, {});
  EXPECT_TRUE(std::isnan(sigma_alone.epv));
}

void expect_invalid(const MatchResult& match) {
  const auto message = mavlink_global_position_sensor(match, {100, 100, 1}, {0, 0, 3, 10, 30});
  EXPECT_EQ(message.flags, kMavlinkPositionUnhealthy);
  EXPECT_EQ(message.lat, kInvalid);
  EXPECT_EQ(message.lon, kInvalid);
  EXPECT_TRUE(std::isnan(message.alt_ellipsoid) && std::isnan(message.alt));
  EXPECT_TRUE(std::isnan(message.eph) && std::isnan(message.epv));
  EXPECT_EQ(message.source, MavlinkPositionSource::kVision);
  EXPECT_EQ(message.id, 3);
  EXPECT_EQ(message.time_usec, 30U);
  EXPECT_EQ(message.processing_time, 20U);
}

TEST(MavlinkPosition, ARefusedMatchIsInvalidAndItsCandidateStaysOut) {
  expect_invalid(testing::refused_match());
  expect_invalid(MatchResult{});
}

TEST(MavlinkPosition, NumbersThatAreNoPositionAreInvalid) {
  const double nan = std::nan("");
  MatchResult match = testing::some_match();
  match.fix->position.lat_deg = 90.1;
  expect_invalid(match);
  match = testing::some_match();
  match.fix->position.lon_deg = nan;
  expect_invalid(match);
  match = testing::some_match();
  match.fix->covariance_en_m2(0, 1) = match.fix->covariance_en_m2(1, 0) = nan;
  expect_invalid(match);
  match = testing::some_match();
  match.fix->covariance_en_m2 << 1, 2, 2, 1;  // a correlation of 2
  expect_invalid(match);
  match = testing::some_match();
  match.fix->covariance_en_m2.setZero();  // nobody is that sure
  expect_invalid(match);
  match = testing::some_match();
  match.fix.reset();
  expect_invalid(match);
}

TEST(MavlinkPosition, ProcessingTimeStaysInItsField) {
  const MatchResult match = testing::some_match();
  EXPECT_EQ(mavlink_global_position_sensor(match, {}, {0, 0, 0, 50, 20}).processing_time, 0U);
  EXPECT_EQ(mavlink_global_position_sensor(match, {}, {0, 0, 0, 0, std::uint64_t{1} << 40}).processing_time,
            std::numeric_limits<std::uint32_t>::max());
}

}  // namespace
}  // namespace pilotage
