#include "pilotage/report/sampled_route.h"

#include <cmath>

#include <gtest/gtest.h>

namespace pilotage {
namespace {

// 101 samples, 10 m apart, crossing the antimeridian; leg 1 starts at 500 m.
std::vector<FlightSample> samples_across_180() {
  std::vector<FlightSample> samples;
  for (int i = 0; i <= 100; ++i) {
    FlightSample sample;
    sample.distance_m = 10.0 * i;
    sample.leg = i < 50 ? 0 : 1;
    sample.point = {wrap_lon_deg(179.95 + 0.001 * i), 10 + 0.0001 * i};
    samples.push_back(sample);
  }
  return samples;
}

TEST(RouteLine, PointsAreInterpolatedAcrossTheAntimeridian) {
  const auto samples = samples_across_180();
  EXPECT_NEAR(route_point_at(samples, 5).lon_deg, 179.9505, 1e-9);
  EXPECT_NEAR(std::abs(route_point_at(samples, 500).lon_deg), 180, 1e-9);
  EXPECT_NEAR(route_point_at(samples, 505).lon_deg, -179.9995, 1e-9);
  EXPECT_NEAR(route_point_at(samples, 505).lat_deg, 10.00505, 1e-9);
}

TEST(RouteLine, OutsideItTakesTheNearerEnd) {
  const auto samples = samples_across_180();
  EXPECT_EQ(route_point_at(samples, -5).lat_deg, samples.front().point.lat_deg);
  EXPECT_EQ(route_point_at(samples, 2000).lat_deg, samples.back().point.lat_deg);
  EXPECT_TRUE(std::isnan(route_point_at({}, 1).lon_deg));
}

TEST(RouteLine, ALineHasBothEndsAndNoMorePointsThanAsked) {
  const auto samples = samples_across_180();
  for (const std::size_t most : {4U, 10U, 1000U}) {
    const auto line = route_line_between(samples, 123, 987, most);
    EXPECT_LE(line.size(), most + 1);
    EXPECT_NEAR(line.front().lat_deg, 10.00123, 1e-9);
    EXPECT_NEAR(line.back().lat_deg, 10.00987, 1e-9);
    for (std::size_t i = 1; i < line.size(); ++i) EXPECT_GE(line[i].lat_deg, line[i - 1].lat_deg);
  }
  EXPECT_EQ(route_line_between(samples, 123, 987, 1000).size(), 2U + 86U);  // 130 … 980
  EXPECT_EQ(route_line_between(samples, 123, 124, 1000).size(), 2U);
}

TEST(RouteLine, ALegTakesItsOwnSamplesOnly) {
  const auto samples = samples_across_180();
  EXPECT_EQ(leg_line(samples, 0, 1000).size(), 50U);
  EXPECT_EQ(leg_line(samples, 1, 1000).size(), 51U);
  const auto thinned = leg_line(samples, 1, 6);
  EXPECT_LE(thinned.size(), 6U);
  EXPECT_EQ(thinned.front().lat_deg, samples[50].point.lat_deg);
  EXPECT_EQ(thinned.back().lat_deg, samples[100].point.lat_deg);
  EXPECT_TRUE(leg_line(samples, 7, 6).empty());
}

}  // namespace
}  // namespace pilotage
