#include "pilotage/route/read_route.h"

#include <cmath>

#include "route/route_files.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/route/sample_route.h"

namespace pilotage {
namespace {

using ::testing::HasSubstr;
using testing::route_error;
using testing::route_file;
using testing::route_file_error;

TEST(ReadRoute, TellsFormatsByContent) {
  const testing::TemporaryFolder folder;
  for (const char* name : {"loop.plan", "mission.waypoints", "antimeridian.geojson"}) {
    const auto disguised = folder / (std::string(name) + ".kml");
    write_file(disguised, read_file(route_file(name)), false);
    EXPECT_EQ(read_route(disguised).format, read_route(route_file(name)).format) << name;
  }
}

/// An archive that is nothing but its end (APPNOTE.TXT 4.3.16), which announces so many entries.
std::string archive_of(int entries) {
  std::string bytes = std::string("PK\x03\x04") + std::string("PK\x05\x06") + std::string(18, '\0');
  for (const std::size_t at : {8, 10}) {
    bytes[4 + at] = static_cast<char>(entries & 255);
    bytes[5 + at] = static_cast<char>(entries >> 8);
  }
  return bytes;
}

// Both would take a library minutes, or a gigabyte, before it says that they hold no route.
TEST(ReadRoute, EntriesAndAttributesAreCountedBeforeTheyAreRead) {
  EXPECT_THAT(route_error(archive_of(1001)), HasSubstr("holds 1001 entries, at most 1000 are allowed"));
  EXPECT_THAT(route_error(archive_of(65535)), HasSubstr("holds 65535 entries"));
  EXPECT_THAT(route_error(archive_of(0)), HasSubstr("cannot be read as KMZ"));
  EXPECT_THAT(route_error("PK\x03\x04PK\x06\x07" + archive_of(3)), HasSubstr("directory for more than 65535 entries"));
  for (const char* element : {"<kml", "<gpx"}) {
    std::string text = element;
    for (int i = 0; i < 10'001; ++i) text += " a" + std::to_string(i) + "=\">\"";
    EXPECT_THAT(route_error(text + "/>"), HasSubstr("has an element of more than 10000 attributes"));
  }
}

TEST(ReadRoute, SaysWhatItCannotRead) {
  EXPECT_EQ(route_error(""), "r: is empty");
  EXPECT_EQ(route_error("\xEF\xBB\xBF \r\n"), "r: is empty");
  EXPECT_THAT(route_error("hello"), HasSubstr("is not a route file that is known here"));
  EXPECT_THAT(route_error("<html></html>"), HasSubstr("is not a route file"));
  EXPECT_THAT(route_error("[1, 2]"), HasSubstr("neither a QGroundControl plan nor GeoJSON"));
  EXPECT_THAT(route_error("{\"a\": 1}"), HasSubstr("neither a QGroundControl plan"));
  EXPECT_THAT(route_error("{\"a\": "), HasSubstr("not valid JSON"));
  EXPECT_THAT(route_error("PK\x03\x04 no archive"), HasSubstr("cannot be read as KMZ"));
  EXPECT_THAT(route_error(std::string("SQLite format 3\0 no database", 28)), HasSubstr("cannot be read as GeoPackage"));
  EXPECT_THAT(route_error("<gpx version=\"1.1\"><trk>"), HasSubstr("r: "));
  EXPECT_THAT(route_file_error("/nowhere/x.plan"), HasSubstr("/nowhere/x.plan: cannot be read"));
  const testing::TemporaryFolder folder;
  write_file(folder / "x.plan", "{}", false);
  EXPECT_THAT(route_file_error(folder / "x.plan"), HasSubstr((folder / "x.plan").string() + ": "));
}

std::string repeated(const std::string& begin, const std::string& position, const std::string& end) {
  std::string text = begin;
  for (std::size_t i = 0; i <= kMaxRouteVertices; ++i) text += position;
  return text + end;
}

// Their marks are counted: none of these is what it begins like.
TEST(ReadRoute, RefusesTooManyPositionsBeforeParsing) {
  for (const std::string& text :
       {repeated("<gpx>", "<trkpt lat=\"1\"", ""), repeated("<kml>", "15,45,1 ", ""), repeated("{", "[ 15,", ""),
        repeated("{", "[-15,", ""), repeated("QGC WPL 110\n", "x\n", "")}) {
    EXPECT_THAT(route_error(text), HasSubstr("r: has 10000")) << text.substr(0, 20);
    EXPECT_THAT(route_error(text), HasSubstr("a route at most 100000; thin it out")) << text.substr(0, 20);
  }
  EXPECT_THAT(route_error("{" + std::string(40 * kMaxRouteVertices + 1, ',')),
              HasSubstr("a route file at most 4000000"));
  EXPECT_THAT(route_error("<gpx" + std::string(40 * kMaxRouteVertices + 1, '<')), HasSubstr("values"));
}

// Whatever the bytes, reading ends with a route or with one of our own errors.
TEST(ReadRoute, SurvivesDamagedFiles) {
  Random random(seed_from_name("ReadRoute.SurvivesDamagedFiles"));
  for (const char* name :
       {"survey.plan", "loop.plan", "mission.waypoints", "track.gpx", "lines.kml", "antimeridian.geojson"}) {
    const std::string bytes = read_file(route_file(name));
    for (int round = 0; round < 60; ++round) {
      std::string damaged = bytes;
      if (round % 2 == 0) damaged.resize(random.below(bytes.size()));
      for (std::uint64_t i = 0; i < 1 + random.below(4) && !damaged.empty(); ++i) {
        damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
      }
      try {
        const Route route = parse_route(name, damaged);
        for (const RouteVertex& vertex : route.vertices) {
          EXPECT_LE(std::abs(vertex.point.lat_deg), 90);
          EXPECT_LE(std::abs(vertex.point.lon_deg), 180);
        }
        EXPECT_FALSE(route.legs.empty());
      } catch (const DataError&) {
      }
    }
  }
}

class RealRoutes : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = testing::real_data_folder() / "routes";
    if (!std::filesystem::is_directory(folder_)) GTEST_SKIP() << testing::kNoRealImagery;
  }
  std::filesystem::path folder_;
};

TEST_F(RealRoutes, PlansAreRead) {
  const Route ardupilot = read_route(folder_ / "ksql_airport_ardupilot.plan");
  EXPECT_EQ(ardupilot.vertices.size(), 7U);
  EXPECT_EQ(ardupilot.vertices.back().kind, "return");
  EXPECT_NEAR(ardupilot.vertices[0].amsl_m, 122.747, 0.001);
  EXPECT_EQ(ardupilot.vertices[1].speed_mps, 5) << "a quadrotor flies at hoverSpeed";
  EXPECT_EQ(read_route(folder_ / "ksql_airport_px4.plan").vertices.size(), 7U);
  EXPECT_EQ(read_route(folder_ / "qgroundcontrol_sample.plan").vertices.size(), 5U);
  const Route survey = read_route(folder_ / "qgroundcontrol_sample_with_survey.plan");
  EXPECT_EQ(survey.vertices.front().kind, "survey");
  EXPECT_GT(survey.vertices.size(), 5U);
  EXPECT_FALSE(survey.camera) << "Manual (no camera specs)";
  const Route wpl = read_route(folder_ / "mission_planner_sample.txt");
  EXPECT_EQ(wpl.vertices.size(), 4U);
}

TEST_F(RealRoutes, BadPlansAreRefusedForTheirFault) {
  const auto error = [&](const char* name) { return route_file_error(folder_ / name); };
  EXPECT_THAT(error("qgroundcontrol_sample_with_survey_missing_items.plan"), HasSubstr(".Items is missing"));
  EXPECT_THAT(error("qgroundcontrol_sample_with_survey_wrong_version.plan"), HasSubstr("version = 9 is not supported"));
  EXPECT_THAT(error("qgroundcontrol_sample_without_mission.plan"), HasSubstr(".mission is missing"));
  EXPECT_THAT(error("qgroundcontrol_sample_wrong_mission_version.plan"), HasSubstr("mission.version = 7"));
  EXPECT_THAT(error("qgroundcontrol_sample_wrong_overall_version.plan"), HasSubstr(".version = 42"));
  EXPECT_THAT(error("qgroundcontrol_sample_with_digicam_control.plan"), HasSubstr("no position to fly to"));
  EXPECT_THAT(error("qgroundcontrol_sample_with_structured_scan.plan"), HasSubstr("no position to fly to"));
}

TEST_F(RealRoutes, GpxTracksAreRead) {
  const Route track = read_route(folder_ / "Mojstrovka.gpx");
  EXPECT_GT(track.vertices.size(), 100U);
  EXPECT_GT(track.vertices[0].amsl_m, 1000);
  EXPECT_THAT(route_file_error(folder_ / "korita-zbevnica.gpx"), HasSubstr("choose one with --layer and --feature"));
  RouteOptions options;
  options.feature = "03-OCT-10 #2";
  options.agl_m = 120;
  const Route chosen = read_route(folder_ / "korita-zbevnica.gpx", options);
  const auto samples = sample_route(chosen, 25);
  EXPECT_GE(samples.size(), chosen.legs.size() * 2);
  EXPECT_EQ(samples.back().agl_m, 120);
}

}  // namespace
}  // namespace pilotage
