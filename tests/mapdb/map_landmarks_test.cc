#include "pilotage/mapdb/map_landmarks.h"

#include <cmath>

#include "mapdb/small_map.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pilotage/base/error.h"
#include "pilotage/base/nan.h"
#include "pilotage/base/random.h"
#include "pilotage/mapdb/map_inspect.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/mapdb/map_verify.h"

namespace pilotage {
namespace {

using testing::error_of;
using ::testing::HasSubstr;

MapDetector detector_of(const std::string& class_name, int filters, std::uint64_t seed) {
  MapDetector one;
  one.detector.class_name = class_name;
  one.detector.gsd_m = 0.47;
  one.detector.window = {45, 5, 5};
  one.detector.context = 1.3;
  one.detector.offset = {0.01, -0.02};
  one.detector.period_deg = filters > 1 ? 180 : 0;
  one.detector.threshold = 0.125;
  one.detector.shortest_m = 14;
  one.detector.longest_m = 27.5;
  one.p_detect = 0.975;
  one.false_alarms_per_km2 = 0.17;
  one.sigma_m = 0.22;
  Random random(seed);
  for (int i = 0; i < filters; ++i) {
    std::vector<float>& filter = one.detector.filters.emplace_back();
    while (filter.size() < one.detector.window.filter_size()) filter.push_back(static_cast<float>(random.normal()));
  }
  return one;
}

MapLandmarks some_landmarks() {
  MapLandmarks landmarks;
  landmarks.detectors = {detector_of("tank", 1, 1), detector_of("Kläranlage", 2, 2)};
  landmarks.landmarks = {{0, 0, {115.5, -32.1}, 18.5, 12.25, true, 0.5},
                         {7, 1, {115.51, -32.11}, 27, kNaN, false, kNaN}};
  return landmarks;
}

/// The small map with landmarks.
void write_with_landmarks(const std::filesystem::path& path, const MapLandmarks& landmarks) {
  testing::SmallMap map = testing::make_small_map();
  map.header.landmarks = true;
  MapWriter writer(path, map.header, true);
  for (std::size_t i = 0; i < map.tiles.size(); ++i) writer.add_tile(map.tiles[i], map.values[i]);
  writer.write_landmarks(landmarks);
  writer.finish();
}

TEST(MapLandmarks, AreReadAsTheyWereWritten) {
  const testing::TemporaryFolder folder;
  const MapLandmarks written = some_landmarks();
  write_with_landmarks(folder / "map.gpkg", written);
  MapReader reader = MapReader::open_unverified(folder / "map.gpkg");
  EXPECT_EQ(reader.info().schema_version, 2);
  ASSERT_TRUE(reader.has_landmarks());
  const auto read = reader.landmarks();
  EXPECT_EQ(read, reader.landmarks()) << "read once";
  ASSERT_EQ(read->detectors.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& [a, a_p, a_false, a_sigma] = written.detectors[i];
    const auto& [b, b_p, b_false, b_sigma] = read->detectors[i];
    EXPECT_EQ(a.class_name, b.class_name);
    EXPECT_EQ(a.gsd_m, b.gsd_m);
    EXPECT_EQ(a.window.side_px, b.window.side_px);
    EXPECT_EQ(a.window.cell_px, b.window.cell_px);
    EXPECT_EQ(a.window.levels, b.window.levels);
    EXPECT_EQ(a.context, b.context);
    EXPECT_EQ(a.offset, b.offset);
    EXPECT_EQ(a.period_deg, b.period_deg);
    EXPECT_EQ(a.threshold, b.threshold);
    EXPECT_EQ(a.shortest_m, b.shortest_m);
    EXPECT_EQ(a.longest_m, b.longest_m);
    EXPECT_EQ(a.filters, b.filters);
    EXPECT_EQ(a_p, b_p);
    EXPECT_EQ(a_false, b_false);
    EXPECT_EQ(a_sigma, b_sigma);
  }
  ASSERT_EQ(read->landmarks.size(), 2U);
  EXPECT_EQ(read->landmarks[0].place.lon_deg, 115.5);
  EXPECT_EQ(read->landmarks[0].place.lat_deg, -32.1);
  EXPECT_EQ(read->landmarks[0].length_m, 18.5);
  EXPECT_EQ(read->landmarks[0].ground_height_m, 12.25);
  EXPECT_TRUE(read->landmarks[0].found);
  EXPECT_EQ(read->landmarks[0].ambiguity, 0.5);
  EXPECT_EQ(read->landmarks[1].id, 7);
  EXPECT_EQ(read->landmarks[1].detector, 1U);
  EXPECT_FALSE(read->landmarks[1].found);
  EXPECT_TRUE(std::isnan(read->landmarks[1].ground_height_m));
  EXPECT_TRUE(std::isnan(read->landmarks[1].ambiguity));

  const VerifyReport report = verify_map(folder / "map.gpkg");
  EXPECT_TRUE(report.ok()) << report.problems.front().message;
  EXPECT_EQ(report.landmarks, 2);
  const MapSummary summary = inspect_map(folder / "map.gpkg");
  EXPECT_EQ(summary.landmarks, 2);
  EXPECT_THAT(summary.landmark_classes, ::testing::ElementsAre("tank", "Kläranlage"));
  EXPECT_THAT(summary.extensions, ::testing::Contains("pilotage_landmarks"));
}

TEST(MapLandmarks, AMapWithoutThemIsOfTheFirstVersion) {
  const testing::TemporaryFolder folder;
  testing::write_map(folder / "map.gpkg", testing::make_small_map());
  MapReader reader = MapReader::open_unverified(folder / "map.gpkg");
  EXPECT_EQ(reader.info().schema_version, 1);
  EXPECT_FALSE(reader.has_landmarks());
  EXPECT_EQ(reader.landmarks(), nullptr);
  MapWriter writer(folder / "other.gpkg", testing::make_small_map().header, false);
  EXPECT_THROW(writer.write_landmarks(some_landmarks()), UsageError);
}

TEST(MapLandmarks, WhatNoMapMayHoldIsNotWritten) {
  const testing::TemporaryFolder folder;
  const auto error_with = [&](auto change) {
    MapLandmarks landmarks = some_landmarks();
    change(landmarks);
    return error_of<UsageError>([&] { write_with_landmarks(folder / "map.gpkg", landmarks); });
  };
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.detectors[1].detector.gsd_m = 0; }),
              HasSubstr("detector 1: gsd_m = 0 is outside"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.detectors[0].detector.window.side_px = 50; }),
              HasSubstr("window_px = 50 is no odd multiple of cell_px = 5"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.detectors[0].detector.filters[0].pop_back(); }),
              HasSubstr("a filter has 3751 numbers, the window asks for 3752"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.detectors[0].detector.filters[0][3] = NAN; }),
              HasSubstr("number 3 of a filter is not finite"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.detectors[0].sigma_m = 31; }), HasSubstr("sigma_m = 31 is outside"));
  EXPECT_THAT(
      error_with([](MapLandmarks& l) { l.detectors[1].detector.class_name = l.detectors[0].detector.class_name; }),
      HasSubstr("two detectors of the class"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.detectors.resize(65, l.detectors[0]); }),
              HasSubstr("65 detectors, a map has at most 64"));
  EXPECT_THAT(error_with([](MapLandmarks& l) {
                LandmarkDetector& detector = l.detectors[0].detector;
                detector.window = {124, 4, 1};
                detector.filters.assign(64, std::vector<float>(detector.window.filter_size()));
                l.detectors[1].detector.window = detector.window;
                l.detectors[1].detector.filters = detector.filters;
              }),
              HasSubstr("bytes of filters, a map has at most 16777216"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.detectors[0].p_detect = 1.1; }), HasSubstr("p_detect = 1.1"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.detectors[0].sigma_m = 0; }), HasSubstr("sigma_m = 0 is outside"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.landmarks[1].id = 0; }), HasSubstr("landmark 0: ids must ascend"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.landmarks[0].detector = 2; }), HasSubstr("there is no detector 2"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.landmarks[0].place.lat_deg = 91; }), HasSubstr("is not on Earth"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.landmarks[0].length_m = -1; }), HasSubstr("length_m = -1"));
  EXPECT_THAT(error_with([](MapLandmarks& l) { l.landmarks[0].ground_height_m = INFINITY; }),
              HasSubstr("no height on Earth"));
  EXPECT_FALSE(std::filesystem::exists(folder / "map.gpkg"));
}

TEST(MapLandmarks, ChangedRowsAreFound) {
  const testing::TemporaryFolder folder;
  const auto change = [&](const std::string& sql) {
    write_with_landmarks(folder / "map.gpkg", some_landmarks());
    Database::create(folder / "map.gpkg", "map").execute(sql);
    MapReader reader = MapReader::open_unverified(folder / "map.gpkg");
    const std::string problem = error_of<DataError>([&] { reader.landmarks(); });
    const VerifyReport report = verify_map(folder / "map.gpkg");
    EXPECT_TRUE(report.any_wrong_digest()) << sql;
    return problem;
  };
  EXPECT_THAT(change("UPDATE pilotage_detectors SET filters = x'00' WHERE id = 1"),
              HasSubstr("detector 1: filters has 1 bytes, a filter 15008"));
  EXPECT_THAT(change("UPDATE pilotage_detectors SET id = 5 WHERE id = 1"), HasSubstr("detectors count from 0"));
  EXPECT_THAT(change("UPDATE pilotage_detectors SET window_px = 9223372036854775807"), HasSubstr("pilotage_detectors"));
  EXPECT_THAT(change("UPDATE landmarks SET detector = 2"), HasSubstr("landmark 0: there is no detector 2"));
  EXPECT_THAT(change("UPDATE landmarks SET lon_deg = 'east'"), HasSubstr("landmarks"));
  EXPECT_THAT(change("UPDATE landmarks SET found = 2"), HasSubstr("landmarks"));
  // A place that is one, but not that of the geometry: for verify alone.
  EXPECT_EQ(change("UPDATE landmarks SET lon_deg = 115.6 WHERE fid = 0"), "");
  const VerifyReport report = verify_map(folder / "map.gpkg");
  EXPECT_TRUE(std::any_of(report.problems.begin(), report.problems.end(), [](const MapProblem& problem) {
    return problem.message.find("landmark 0: its geometry is not the point of its lon_deg and lat_deg") !=
           std::string::npos;
  }));
  write_with_landmarks(folder / "map.gpkg", some_landmarks());
  Database::create(folder / "map.gpkg", "map").execute("DROP TABLE pilotage_detectors");
  EXPECT_THAT(error_of<DataError>([&] { MapReader::open_unverified(folder / "map.gpkg"); }),
              HasSubstr("landmarks without detectors"));
}

}  // namespace
}  // namespace pilotage
