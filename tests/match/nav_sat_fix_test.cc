#include "pilotage/match/nav_sat_fix.h"

#include <cmath>
#include <type_traits>

#include "match/some_fix.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

// NavSatFix.msg, NavSatStatus.msg and builtin_interfaces/Time.msg, field by field.
TEST(NavSatFix, FieldsAreThoseOfTheDefinition) {
  static_assert(std::is_same_v<decltype(NavSatFix::stamp_sec), std::int32_t>);
  static_assert(std::is_same_v<decltype(NavSatFix::stamp_nanosec), std::uint32_t>);
  static_assert(std::is_same_v<decltype(NavSatFix::status), std::int8_t>);
  static_assert(std::is_same_v<decltype(NavSatFix::service), std::uint16_t>);
  static_assert(std::is_same_v<decltype(NavSatFix::latitude), double>);
  static_assert(std::is_same_v<decltype(NavSatFix::position_covariance), std::array<double, 9>>);
  static_assert(std::is_same_v<decltype(NavSatFix::position_covariance_type), std::uint8_t>);
  EXPECT_EQ(kNavSatStatusNoFix, -1);
  EXPECT_EQ(kNavSatStatusFix, 0);
  EXPECT_EQ(kNavSatServiceUnknown, 0);
  EXPECT_EQ(kNavSatCovarianceUnknown, 0);
  EXPECT_EQ(kNavSatCovarianceApproximated, 1);
  EXPECT_EQ(kNavSatCovarianceKnown, 3);
}

TEST(NavSatFix, TellsOfAFix) {
  const MatchResult match = testing::some_match();
  const NavSatFix message =
      nav_sat_fix(match, altitude_over(*match.fix, 55.25, std::nan(""), 4), 1'763'731'384'123'456'789, "base_link");
  EXPECT_EQ(message.stamp_sec, 1'763'731'384);
  EXPECT_EQ(message.stamp_nanosec, 123'456'789U);
  EXPECT_EQ(message.frame_id, "base_link");
  EXPECT_EQ(message.status, kNavSatStatusFix);
  EXPECT_EQ(message.service, kNavSatServiceUnknown);
  EXPECT_EQ(message.latitude, -1.0745678912);
  EXPECT_EQ(message.longitude, 114.8741234567);
  EXPECT_EQ(message.altitude, 175.25);
  const double between = match.fix->covariance_en_m2(0, 1);
  EXPECT_THAT(message.position_covariance, ElementsAre(7, between, 0, between, 13, 0, 0, 0, 25));
  EXPECT_EQ(message.position_covariance_type, kNavSatCovarianceKnown);
}

TEST(NavSatFix, UnknownAltitude) {
  const MatchResult match = testing::some_match();
  const double nan = std::nan("");
  for (const FixAltitude& altitude : {FixAltitude{}, FixAltitude{nan, 100, 2}}) {  // mean sea level does not help ROS
    const NavSatFix message = nav_sat_fix(match, altitude, 0, "");
    EXPECT_EQ(message.status, kNavSatStatusFix);
    EXPECT_TRUE(std::isnan(message.altitude));
    EXPECT_EQ(message.position_covariance[8], kUnknownAltitudeVariance_m2);
    EXPECT_EQ(message.position_covariance[0], 7);
    EXPECT_EQ(message.position_covariance_type, kNavSatCovarianceApproximated);
  }
  const NavSatFix no_sigma = nav_sat_fix(match, {150, nan, nan}, 0, "");
  EXPECT_EQ(no_sigma.altitude, 150);
  EXPECT_EQ(no_sigma.position_covariance[8], kUnknownAltitudeVariance_m2);
  EXPECT_EQ(no_sigma.position_covariance_type, kNavSatCovarianceApproximated);
}

TEST(NavSatFix, ARefusedMatchHasNoFixAndItsCandidateStaysOut) {
  MatchResult not_finite = testing::some_match();
  not_finite.fix->covariance_en_m2(1, 1) = std::numeric_limits<double>::infinity();
  for (const MatchResult& match : {testing::refused_match(), MatchResult{}, not_finite}) {
    const NavSatFix message = nav_sat_fix(match, {100, 100, 1}, 1'500'000'000, "camera");
    EXPECT_EQ(message.status, kNavSatStatusNoFix);
    EXPECT_TRUE(std::isnan(message.latitude) && std::isnan(message.longitude) && std::isnan(message.altitude));
    EXPECT_THAT(message.position_covariance, Each(0.0));
    EXPECT_EQ(message.position_covariance_type, kNavSatCovarianceUnknown);
    EXPECT_EQ(message.stamp_sec, 1);
    EXPECT_EQ(message.stamp_nanosec, 500'000'000U);
    EXPECT_EQ(message.frame_id, "camera");
  }
}

TEST(NavSatFix, AntimeridianAndOddTimes) {
  MatchResult match = testing::some_match();
  match.fix->position = {180, -17};
  EXPECT_EQ(nav_sat_fix(match, {}, 0, "").longitude, -180);
  match.fix->position = {-190.5, -17};
  EXPECT_NEAR(nav_sat_fix(match, {}, 0, "").longitude, 169.5, 1e-9);
  const NavSatFix before = nav_sat_fix(match, {}, -1, "");
  EXPECT_EQ(before.stamp_sec, -1);
  EXPECT_EQ(before.stamp_nanosec, 999'999'999U);
  EXPECT_EQ(nav_sat_fix(match, {}, std::int64_t{5'000'000'000} * 1'000'000'000, "").stamp_sec, 2147483647);
}

}  // namespace
}  // namespace pilotage
