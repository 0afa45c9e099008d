#include "pilotage/route/track_speed.h"

#include <cmath>
#include <string>

#include "route/route_files.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace pilotage {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::route_error;

/// The speeds of the legs of a track; no leg, no speed: the first vertex has the mean.
std::vector<double> track_speeds(const std::vector<TrackStep>& steps, Route& route) {
  route.vertices.resize(steps.size() + 1);
  TrackTimes times{steps, 0, true};
  for (std::size_t i = 0; i < steps.size(); ++i) times.steps[i].vertex = static_cast<int>(i) + 1;
  set_track_speeds(route, times);
  std::vector<double> speeds;
  for (std::size_t i = 1; i < route.vertices.size(); ++i) speeds.push_back(route.vertices[i].speed_mps);
  return speeds;
}

TEST(TrackSpeed, LongStepsHaveTheirOwn) {
  Route route;
  const auto speeds = track_speeds({{0, 100, 10}, {0, 60, 10}}, route);
  EXPECT_DOUBLE_EQ(speeds[0], 10);
  EXPECT_DOUBLE_EQ(speeds[1], 6);
  EXPECT_THAT(route.notes, Contains(HasSubstr("6.0 m/s to 10.0 m/s.")));
}

// Four positions a second whose times are whole seconds: no leg is faster than the others.
TEST(TrackSpeed, WholeSecondsDoNotMakeJumps) {
  std::vector<TrackStep> steps;
  for (int i = 0; i < 40; ++i) steps.push_back({0, 2, i % 4 == 3 ? 1.0 : 0.0});
  Route route;
  for (const double speed : track_speeds(steps, route)) EXPECT_NEAR(speed, 8, 2);
}

TEST(TrackSpeed, UnknownAndBackwardTimesTakeTheMean) {
  Route route;
  const auto speeds = track_speeds({{0, 100, 10}, {0, 100, -5}, {0, 50, NAN}, {0, 300, 10}}, route);
  EXPECT_DOUBLE_EQ(speeds[1], 20);
  EXPECT_DOUBLE_EQ(speeds[2], 20);
  EXPECT_THAT(route.notes, Contains(HasSubstr("2 of 4 legs, whose times are missing")));
}

TEST(TrackSpeed, StandingStillIsNotFlight) {
  Route route;
  const auto speeds = track_speeds({{0, 100, 10}, {0, 1, 600}, {0, 100, 10}}, route);
  EXPECT_DOUBLE_EQ(speeds[1], 10);
  EXPECT_THAT(route.notes, Contains(HasSubstr("600 s of standing still are not counted")));
}

TEST(TrackSpeed, NoUsableTimeGivesNoSpeed) {
  Route route;
  const auto speeds = track_speeds({{0, 100, 0}, {0, 100, -1}}, route);
  EXPECT_TRUE(std::isnan(speeds[0]));
  EXPECT_THAT(route.notes, Contains(HasSubstr("give no speed")));
}

std::string gx_track(const std::string& inside) {
  return R"(<?xml version="1.0"?><kml xmlns="http://www.opengis.net/kml/2.2" )"
         R"(xmlns:gx="http://www.google.com/kml/ext/2.2"><Document><Placemark><name>flight</name><gx:Track>)" +
         inside + "</gx:Track></Placemark></Document></kml>";
}

const std::string kCoords =
    "<gx:coord>8 47 135</gx:coord><gx:coord>8 47.01 145</gx:coord><gx:coord>8 47.02 155</gx:coord>";
const std::string kWhens =
    "<when>2025-03-03T08:00:00Z</when><when>2025-03-03T08:01:40Z</when><when>2025-03-03T10:03:20+02:00</when>";

TEST(TrackSpeed, GxTrackHasHeightsAndTimes) {
  const Route route = parse_route("r", gx_track("<altitudeMode>absolute</altitudeMode>" + kWhens + kCoords));
  ASSERT_EQ(route.vertices.size(), 3U);
  EXPECT_EQ(route.vertices[2].amsl_m, 155);
  EXPECT_NEAR(route.vertices[1].speed_mps, 11.12, 0.02);
  EXPECT_NEAR(route.vertices[2].speed_mps, 11.12, 0.02) << "the time zone counts";
  EXPECT_THAT(route.notes, Not(Contains(HasSubstr("does not say what they are measured from"))));
  const Route low = parse_route("r", gx_track("<altitudeMode>relativeToGround</altitudeMode>" + kWhens + kCoords));
  ASSERT_EQ(low.vertices.size(), 3U);
  EXPECT_EQ(low.vertices[2].agl_m, 155);
  EXPECT_TRUE(std::isnan(low.vertices[2].amsl_m));
}

// GDAL 3.6 reads beyond the last time of such tracks, and may end the program.
TEST(TrackSpeed, ATrackWithoutTimesIsRefused) {
  EXPECT_THAT(route_error(gx_track("<altitudeMode>absolute</altitudeMode>" + kCoords)),
              HasSubstr("r: has a gx:Track with 0 times (<when>) for 3 positions"));
}

TEST(TrackSpeed, AsManyTimesAsPositions) {
  const std::string begin = "<altitudeMode>absolute</altitudeMode>";
  EXPECT_THAT(route_error(gx_track(begin + "<when>2025-03-03T08:00:00Z</when>" + kCoords)),
              HasSubstr("with 1 times (<when>) for 3 positions"));
  const Route route = parse_route("r", gx_track(begin + kWhens + "<when>2025-03-03T09:00:00Z</when>" + kCoords));
  EXPECT_TRUE(std::isnan(route.vertices[1].speed_mps));
  EXPECT_THAT(route.notes, Contains(HasSubstr("has 4 times for 3 positions: they are not used")));
}

TEST(TrackSpeed, GpxTimesGiveSpeeds) {
  const std::string text =
      R"(<gpx version="1.1" creator="t" xmlns="http://www.topografix.com/GPX/1/1"><trk><name>a</name><trkseg>)"
      R"(<trkpt lat="47" lon="8"><time>2025-03-03T08:00:00Z</time></trkpt>)"
      R"(<trkpt lat="47.01" lon="8"><time>2025-03-03T08:01:40Z</time></trkpt></trkseg></trk></gpx>)";
  const Route route = parse_route("r", text);
  EXPECT_NEAR(route.vertices[1].speed_mps, 11.12, 0.02);
  EXPECT_THAT(route.notes, Contains(HasSubstr("Speeds come from the times of the positions")));
}

TEST(TrackSpeed, RealTrackHasHeightsAndTimes) {
  const std::filesystem::path data = testing::real_data_folder();
  const std::filesystem::path file = data / "routes" / "drones" / "gx.kml";
  if (data.empty() || !std::filesystem::exists(file)) GTEST_SKIP() << testing::kNoRealImagery;
  const Route route = read_route(file);
  EXPECT_EQ(route.vertices[0].amsl_m, 135);
  EXPECT_NEAR(route.vertices[1].speed_mps, route.legs[0].length_m / 30, 1e-6);
}

}  // namespace
}  // namespace pilotage
