#include "pilotage/vehiclelog/pose_at.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

TEST(PoseAt, BetweenRecordsAndNotBeyondReach) {
  const std::vector<LoggedPosition> positions{{10, {179.9, 50}, 100}, {12, {-179.9, 51}, 110}};
  const auto middle = position_at(positions, 11, 5);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(std::abs(middle->point.lon_deg), 180, 1e-9);
  EXPECT_EQ(middle->point.lat_deg, 50.5);
  EXPECT_EQ(middle->amsl_m, 105);
  EXPECT_FALSE(position_at(positions, 11, 0.5));
  EXPECT_EQ(position_at(positions, 10.4, 0.5)->point.lat_deg, 50) << "only the record before is near enough";
  EXPECT_EQ(position_at(positions, 13, 1)->point.lat_deg, 51);
  EXPECT_FALSE(position_at(positions, 13.1, 1));
  EXPECT_FALSE(position_at({}, 1, 1e9));
}

TEST(PoseAt, AnglesTakeTheShorterWay) {
  const std::vector<LoggedAttitude> attitudes{{0, {170, 0, -10}}, {1, {-170, 10, 10}}};
  const auto middle = attitude_at(attitudes, 0.5, 1);
  ASSERT_TRUE(middle);
  EXPECT_NEAR(std::abs(middle->yaw_deg), 180, 1e-9);
  EXPECT_EQ(middle->pitch_deg, 5);
  EXPECT_EQ(middle->roll_deg, 0);
}

TEST(PoseAt, TwoRecordsOfOneTime) {
  const std::vector<LoggedHeight> heights{{1, 5}, {1, 7}};
  EXPECT_EQ(height_at(heights, 1, 1), 5);
}

}  // namespace
}  // namespace pilotage
