#include "pilotage/report/waypoints.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::HasSubstr;

/// Home, a waypoint 600 m on and one 1,200 m further at twice the speed; a fourth that no leg reaches.
Flight three_waypoints() {
  Flight flight;
  flight.route.vertices.resize(4);
  for (std::size_t i = 0; i < 4; ++i) {
    flight.route.vertices[i].point = {16.5 + 0.01 * static_cast<double>(i), 55.5};
    flight.route.vertices[i].source_item = static_cast<int>(i) * 2;
    flight.route.vertices[i].kind = i == 0 ? "home" : "waypoint";
  }
  flight.route.vertices[2].agl_m = 100;
  flight.route.legs = {{0, 1, 600}, {1, 2, 1200}};
  flight.route.items.push_back({0, 16, "waypoint", "1 vertex"});
  const auto sample = [&](int leg, double distance_m, double speed_mps, double agl_m) {
    FlightSample& next = flight.samples.emplace_back();
    next.leg = leg;
    next.distance_m = distance_m;
    next.speed_mps = speed_mps;
    next.agl_m = agl_m;
  };
  sample(0, 0, 10, 60);
  sample(0, 600, 10, 70);
  sample(1, 600, 20, 70);
  sample(1, 1800, 20, 90);
  return flight;
}

TEST(Waypoints, SayWhenAndHowHighTheyArePassed) {
  const auto all = waypoints(three_waypoints());
  ASSERT_EQ(all.size(), 4U);
  EXPECT_EQ(all[1].number, 2);
  EXPECT_EQ(all[1].item, 2);
  EXPECT_EQ(all[1].distance_m, 600);
  EXPECT_EQ(all[1].time_s, 60);
  EXPECT_EQ(all[1].agl_m, 70) << "the flight's, where the route tells none";
  EXPECT_EQ(all[2].time_s, 120);
  EXPECT_EQ(all[2].agl_m, 100) << "the route's own";
  EXPECT_TRUE(std::isnan(all[3].distance_m)) << "no leg reaches it";
}

TEST(Waypoints, FilesWithoutItemNumbersHaveNone) {
  Flight flight = three_waypoints();
  flight.route.items[0].command = -1;
  EXPECT_EQ(waypoints(flight)[1].item, -1);
}

TEST(Waypoints, AreATableThatStaysShort) {
  const std::string html = waypoints_html(waypoints(three_waypoints()));
  EXPECT_THAT(html, HasSubstr("55.500000, 16.520000"));
  EXPECT_THAT(html, HasSubstr("<td data-label=\"Time\">2:00</td>"));
  EXPECT_THAT(html, HasSubstr("<td data-label=\"Time\">–</td>"));
  std::vector<Waypoint> many(5000);
  many[0].kind = "<b>";
  many[1].time_s = 3723;
  const std::string cut = waypoints_html(many);
  EXPECT_THAT(cut, HasSubstr("… and 4500 more"));
  EXPECT_THAT(cut, HasSubstr("&lt;b&gt;"));
  EXPECT_THAT(cut, HasSubstr("1:02:03"));
}

}  // namespace
}  // namespace pilotage
