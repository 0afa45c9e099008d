#include "pilotage/reroute/reroute.h"

#include "matchability/known_level.h"
#include "raster/raster_maker.h"
#include "testing/error_of.h"
#include "testing/temporary_folder.h"
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/base/random.h"
#include "pilotage/base/text.h"
#include "pilotage/prepare/prepare.h"
#include "pilotage/raster/gdal_crs.h"
#include "pilotage/route/read_route.h"

namespace pilotage {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

GeodeticPoint on_map(double east_m, double south_m) {
  return CrsTransform(testing::utm33()).geodetic_from_map({500000 + east_m, 5'000'000 - south_m}).value();
}

std::string lon_lat(GeodeticPoint point) {
  return "[" + format_number(point.lon_deg) + "," + format_number(point.lat_deg) + "]";
}

// 1,100 m × 700 m of ground that no place of repeats, but for a field as plain as water across the way: 300 m wide,
// from the lower edge up to 330 m below the upper one. The planned line runs straight over it.
RerouteOptions over_plain_ground(const fs::path& folder) {
  testing::RasterSpec spec;
  spec.width = 1100;
  spec.height = 700;
  spec.place = GeoTransform::north_up(500000, 5'000'000, 1);
  Random random(seed_from_name("over plain ground"));
  std::vector<double> blocks(138 * 88);
  for (double& block : blocks) block = 20.0 + static_cast<double>(random.below(200));
  spec.value = [&](int, int col, int row) {
    const bool plain = col >= 400 && col < 700 && row >= 330;
    return plain ? 90.0 : blocks[static_cast<std::size_t>(row / 8 * 138 + col / 8)];
  };
  RerouteOptions options;
  TileOptions& tile = options.mission.tile;
  tile.imagery = {testing::make_raster(folder / "ortho.tif", spec)};
  write_file(folder / "route.geojson",
             R"({"type":"Feature","properties":{},"geometry":{"type":"LineString","coordinates":[)" +
                 lon_lat(on_map(120, 420)) + "," + lon_lat(on_map(980, 420)) + "]}}",
             true);
  tile.route = (folder / "route.geojson").string();
  tile.route_options.agl_m = 110;
  tile.route_options.speed_mps = 15;
  tile.camera.hfov_deg = 60;
  tile.camera.width_px = 640;
  tile.camera.height_px = 480;
  tile.ins.grade = InsGrade::kConsumer;
  tile.max_error_m = 35;
  options.mission.score.degraded_copies = 1;
  options.mission.score.model = testing::model_of_known_level(folder);
  return options;
}

RerouteRun run_to(const fs::path& output, int threads = 1) {
  RerouteRun run;
  run.output = output;
  run.threads = threads;
  return run;
}

std::string zone_file(const fs::path& folder, double west, double north, double east, double south) {
  const std::vector<GeodeticPoint> corners = {on_map(west, north), on_map(east, north), on_map(east, south),
                                              on_map(west, south), on_map(west, north)};
  std::vector<std::string> texts;
  for (const GeodeticPoint corner : corners) texts.push_back(lon_lat(corner));
  write_file(folder / "zones.geojson", R"({"type":"Polygon","coordinates":[[)" + join(texts, ",") + "]]}", true);
  return (folder / "zones.geojson").string();
}

// Issue 13, 2.2: NO-GO in, a plan out that is GO; and by the very words of `prepare`.
TEST(Reroute, LeadsAroundGroundThatIsNotRecognised) {
  const testing::TemporaryFolder folder;
  const RerouteOptions options = over_plain_ground(folder.path());
  const RerouteResult result = reroute(options, run_to(folder / "better.plan"));
  EXPECT_EQ(result.before.verdict, QualityStatus::kBad) << result.before.verdict_text;
  EXPECT_TRUE(result.found_go) << result.after.verdict_text;
  EXPECT_GT(result.after.length_m, result.before.length_m + 20);
  EXPECT_LT(result.after.length_m, 2 * result.before.length_m);

  PrepareOptions prepared = options.mission;
  prepared.tile.route = (folder / "better.plan").string();
  PrepareRun run;
  run.output_folder = folder / "out";
  run.threads = 1;
  EXPECT_EQ(prepare(prepared, run).verdict, result.after.verdict_text);
  EXPECT_EQ(prepare(prepared,
                    [&] {
                      PrepareRun other = run;
                      other.output_folder = folder / "planned";
                      prepared.tile.route = options.mission.tile.route;
                      return other;
                    }())
                .verdict,
            result.before.verdict_text);

  const Route route = read_route(folder / "better.plan", options.mission.tile.route_options);
  EXPECT_NEAR(route_length_m(route), result.after.length_m, 1e-6);
  EXPECT_EQ(route.vertices.size(), result.after.points.size());
  const GeodeticPoint start = on_map(120, 420);
  EXPECT_EQ(route.vertices.front().point.lon_deg, start.lon_deg) << "the ends stay, to the last bit";
  EXPECT_EQ(route.vertices.front().point.lat_deg, start.lat_deg);
  for (const char* name : {"better.json", "better.geojson", "better.html"}) EXPECT_TRUE(fs::exists(folder / name));

  // The page shows the imagery below the tiles, in its place.
  const DegreePicture& seen = result.imagery;
  const auto gray_at = [&](double east_m, double south_m) {
    const GeodeticPoint place = on_map(east_m, south_m);
    const double x = (place.lon_deg - seen.west_deg) / (seen.east_deg - seen.west_deg) * seen.rgba.cols;
    const double y = (seen.north_deg - place.lat_deg) / (seen.north_deg - seen.south_deg) * seen.rgba.rows;
    return seen.rgba.at<cv::Vec4b>(static_cast<int>(y), static_cast<int>(x))[0];
  };
  int plain = 0;
  for (double east_m = 410; east_m < 700; east_m += 20) {
    for (double south_m = 340; south_m < 480; south_m += 20) plain += gray_at(east_m, south_m) == 90;
  }
  EXPECT_EQ(plain, 15 * 7);
  int as_plain = 0;
  for (double east_m = 410; east_m < 700; east_m += 20) as_plain += gray_at(east_m, 320) == 90;
  EXPECT_LT(as_plain, 5);
  EXPECT_THAT(read_file(folder / "better.html"), HasSubstr("href=\"data:image/jpeg;base64,"));
}

TEST(Reroute, SameBytesForAnyNumberOfThreads) {
  const testing::TemporaryFolder folder;
  const RerouteOptions options = over_plain_ground(folder.path());
  fs::create_directory(folder / "one");
  fs::create_directory(folder / "three");
  const RerouteResult expected = reroute(options, run_to(folder / "one/better.plan", 1));
  reroute(options, run_to(folder / "three/better.plan", 3));
  for (const std::string& name : expected.files) {
    EXPECT_EQ(read_file(folder / ("one/" + name)), read_file(folder / ("three/" + name))) << name;
  }
}

TEST(Reroute, StaysClearOfZonesAndSaysWhenItCannot) {
  const testing::TemporaryFolder folder;
  RerouteOptions options = over_plain_ground(folder.path());
  // The upper part, by which the line leads, is closed but for a gate of 180 m.
  options.line.avoid = {zone_file(folder.path(), 500, -50, 600, 150)};
  const RerouteResult around = reroute(options, run_to(folder / "around.plan"));
  EXPECT_EQ(around.after.no_fly_m, 0);
  options.line.avoid = {zone_file(folder.path(), 500, -50, 600, 750)};  // from edge to edge
  EXPECT_THAT(testing::error_of<DataError>([&] { reroute(options, run_to(folder / "never.plan")); }),
              HasSubstr("no line leads from the start to the end"));
  EXPECT_FALSE(fs::exists(folder / "never.plan"));
  options.line.avoid = {zone_file(folder.path(), 80, 380, 160, 460)};
  EXPECT_THAT(testing::error_of<DataError>([&] { reroute(options, run_to(folder / "never.plan")); }),
              HasSubstr("the start, lon "));
}

TEST(Reroute, KeepsWithinWhatItIsTold) {
  const testing::TemporaryFolder folder;
  RerouteOptions options = over_plain_ground(folder.path());
  options.line.keep_within_m = 60;  // not enough to get around
  const RerouteResult result = reroute(options, run_to(folder / "better.plan"));
  EXPECT_FALSE(result.found_go);
  EXPECT_NE(result.after.verdict, QualityStatus::kGood);
  for (const GeodeticPoint point : result.after.points) {
    const Eigen::Vector2d at = CrsTransform(testing::utm33()).map_from_geodetic(point).value();
    EXPECT_LE(std::abs(5'000'000 - 420 - at.y()), 60.01);
  }
}

TEST(Reroute, RefusesWhatItCannotDo) {
  const testing::TemporaryFolder folder;
  const RerouteOptions good = over_plain_ground(folder.path());
  const auto error = [&](auto change) {
    RerouteOptions options = good;
    change(options);
    return testing::error_of<std::runtime_error>([&] { reroute(options, run_to(folder / "x.plan")); });
  };
  EXPECT_THAT(error([](auto& o) { o.line.keep = {1}; }), HasSubstr("every leg of route.geojson is to be kept"));
  EXPECT_THAT(error([](auto& o) { o.line.keep = {2}; }),
              HasSubstr("keep = 2 is no leg of the route, which has legs 1 to 1"));
  EXPECT_THAT(error([](auto& o) { o.line.from = {15, 45}; }), HasSubstr("from and to belong together"));
  EXPECT_THAT(error([](auto& o) { o.line.from = o.line.to = {15, 45}; }), HasSubstr("from and to are one place"));
  EXPECT_THAT(error([](auto& o) { o.mission.tile.denied = {{"0.1-0.2"}}; }),
              HasSubstr("a stretch of the planned line"));
  EXPECT_THAT(error([](auto& o) {
                o.line.from = {15.001, 45};
                o.line.to = {16, 45};
              }),
              HasSubstr("lies outside the imagery"));
  EXPECT_THAT(testing::error_of<UsageError>([&] { reroute(good, run_to(folder / "x.kml")); }),
              HasSubstr("named *.plan, or a DJI mission besides, named *.kmz"));
  EXPECT_FALSE(fs::exists(folder / "x.plan"));
}

}  // namespace
}  // namespace pilotage
