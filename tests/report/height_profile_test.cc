#include "pilotage/report/height_profile.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::HasSubstr;

Flight flight_over(const std::vector<double>& ground_m, double flown_m) {
  Flight flight;
  flight.min_agl_m = 30;
  for (std::size_t i = 0; i < ground_m.size(); ++i) {
    FlightSample& sample = flight.samples.emplace_back();
    sample.distance_m = 10.0 * static_cast<double>(i);
    sample.amsl_m = flown_m;
    sample.agl_m = flown_m - ground_m[i];
  }
  return flight;
}

TEST(HeightProfile, HasTheGroundUnderTheFlight) {
  const HeightProfile profile = height_profile(flight_over({20, 50, 35}, 120));
  ASSERT_EQ(profile.samples.size(), 3U);
  EXPECT_TRUE(profile.above_sea);
  EXPECT_EQ(profile.samples[1].ground_m, 50);
  EXPECT_EQ(profile.samples[1].flown_m, 120);
  EXPECT_THAT(height_profile_svg(profile, 20),
              AllOf(HasSubstr("at least 70 m above ground"), HasSubstr("above sea level")));
}

TEST(HeightProfile, CountsFromTheGroundWhereNothingTellsTheSea) {
  Flight flight = flight_over({0, 0}, 80);
  for (FlightSample& sample : flight.samples) sample.amsl_m = std::nan("");
  const HeightProfile profile = height_profile(flight);
  EXPECT_FALSE(profile.above_sea);
  EXPECT_EQ(profile.samples[0].ground_m, 0);
  EXPECT_EQ(profile.samples[0].flown_m, 80);
  EXPECT_EQ(height_profile_svg(height_profile({}), 100), "");
}

// A mast-like hill between thousands of samples must not be thinned away: it is what the planner has to see.
TEST(HeightProfile, KeepsTheLeastHeightAboveGround) {
  std::vector<double> ground_m(50'000, 10);
  ground_m[31'337] = 99;
  const HeightProfile profile = height_profile(flight_over(ground_m, 120));
  EXPECT_LE(profile.samples.size(), 1000U);
  EXPECT_TRUE(std::any_of(profile.samples.begin(), profile.samples.end(),
                          [](const HeightSample& sample) { return sample.ground_m == 99; }));
  EXPECT_EQ(profile.samples.back().distance_m, 499'990);
  EXPECT_TRUE(std::is_sorted(profile.samples.begin(), profile.samples.end(),
                             [](const HeightSample& a, const HeightSample& b) { return a.distance_m < b.distance_m; }));
}

}  // namespace
}  // namespace pilotage
