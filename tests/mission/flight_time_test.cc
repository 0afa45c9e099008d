#include "pilotage/mission/flight_time.h"

#include <cmath>

#include <gtest/gtest.h>

#include "pilotage/base/nan.h"

namespace pilotage {
namespace {

FlightSample sample(double distance_m, double speed_mps) {
  FlightSample at;
  at.distance_m = distance_m;
  at.speed_mps = speed_mps;
  return at;
}

TEST(FlightTime, EachLegIsFlownAtItsSpeed) {
  const std::vector<FlightSample> samples = {sample(0, 10), sample(150, 10), sample(300, 10), sample(300, 30),
                                             sample(600, 30)};
  EXPECT_DOUBLE_EQ(step_time_s(samples[0], samples[1]), 15);
  EXPECT_EQ(step_time_s(samples[2], samples[3]), 0) << "from leg to leg";
  EXPECT_DOUBLE_EQ(flight_time_s(samples), 40);
}

TEST(FlightTime, IsNotKnownWhereASpeedIsNot) {
  EXPECT_TRUE(std::isnan(flight_time_s({sample(0, kNaN), sample(300, 10)})));
  EXPECT_DOUBLE_EQ(flight_time_s({sample(0, 10), sample(300, kNaN)}), 30) << "nothing is flown at it";
  EXPECT_EQ(flight_time_s({sample(7, 10)}), 0);
  EXPECT_EQ(flight_time_s({}), 0);
}

}  // namespace
}  // namespace pilotage
