// Frames of a straight flight over a map, a few metres apart, matched one after the other on one core: frames a second
// with the reader's cache of decoded tiles and without it, and how much of the time goes into the map.
//   bench_match_overlapping MAP.gpkg RASTER LON_DEG LAT_DEG LON_DEG LAT_DEG SPACING_M ROUNDS
// RASTER shows the ground of the frames (another date, say) from the first place to the second; height and camera are
// those the map was prepared for, the camera with 800 columns. docs/benchmarks.md has the numbers.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "pilotage/camera/render_frame.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/mapdb/map_reader.h"
#include "pilotage/match/match.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr int kWidthPx = 800;

struct Shot {
  cv::Mat frame;
  MatchPrior prior;
};

struct Flight {
  Camera camera;
  std::vector<Shot> shots;
};

Flight fly(const std::string& map_path, const std::string& raster, GeodeticPoint from, GeodeticPoint to,
           double spacing_m) {
  const MapReader map = MapReader::open_unverified(map_path);
  if (!map.camera()) throw std::runtime_error(map_path + ": has no camera");
  Flight flight;
  const Camera& whole = *map.camera();
  flight.camera = camera_for_size("the frames", whole, kWidthPx, kWidthPx * whole.height_px / whole.width_px);
  const MapLevel& level = map.levels().front();
  const double agl_m = (level.min_agl_m + level.max_agl_m) / 2;
  const GraySource ground = stretch_to_8bit(open_gray(raster));
  const Crs crs = inspect_imagery(raster).crs;
  const GeodesicLeg line = geodesic_between(from, to);
  for (double along_m = 0; along_m <= line.length_m; along_m += spacing_m) {
    const GeodeticPoint nadir = geodesic_direct(from, line.start_azimuth_deg, along_m);
    const auto on_raster = CrsTransform(crs).map_from_geodetic(nadir);
    if (!on_raster) throw std::runtime_error(raster + ": the flight leaves it");
    const GroundPlace place =
        ground_place(crs, ground.map_from_pixel, ground.map_from_pixel.pixel_from_map(*on_raster));
    const Attitude attitude{line.start_azimuth_deg, 0, 0};
    const RenderedFrame frame = render_frame(ground, place, flight.camera, attitude, agl_m);
    if (frame.valid_fraction < 1) continue;
    flight.shots.push_back(
        {frame.gray,
         {LocalFrame(nadir).geodetic_from_enu({9, -7, 0}), isotropic_covariance_m2(15), agl_m * 1.01, attitude}});
  }
  if (flight.shots.empty()) throw std::runtime_error(raster + ": shows the ground of no frame");
  return flight;
}

struct Round {
  double seconds = 0;
  int fixes = 0;
  std::vector<double> places;  ///< Longitude and latitude of each fix.
};

Round match_all(const Flight& flight, const std::string& map_path, std::size_t cache_bytes) {
  MapReader map = MapReader::open_unverified(map_path, cache_bytes);
  Round round;
  const auto start = std::chrono::steady_clock::now();
  for (const Shot& shot : flight.shots) {
    const MatchResult result = match(shot.frame, shot.prior, flight.camera, map);
    if (!result.fix) continue;
    ++round.fixes;
    round.places.insert(round.places.end(), {result.fix->position.lon_deg, result.fix->position.lat_deg});
  }
  round.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return round;
}

int run(const std::vector<std::string>& arguments) {
  cv::setNumThreads(1);
  const auto number = [&](std::size_t i) { return std::stod(arguments[i]); };
  const Flight flight = fly(arguments[0], arguments[1], {number(2), number(3)}, {number(4), number(5)}, number(6));
  const auto frames = static_cast<double>(flight.shots.size());
  std::vector<double> with;
  std::vector<double> without;
  for (int i = 0; i < std::stoi(arguments[7]); ++i) {  // by turns, so that the machine's moods meet both
    const Round a = match_all(flight, arguments[0], 0);
    const Round b = match_all(flight, arguments[0], kDefaultTileCacheBytes);
    if (a.places != b.places) throw std::runtime_error("the cache changes the fixes");
    without.push_back(a.seconds);
    with.push_back(b.seconds);
    if (i == 0) std::printf("%zu frames, %d fixes\n", flight.shots.size(), a.fixes);
  }
  const double best_with = *std::min_element(with.begin(), with.end());
  const double best_without = *std::min_element(without.begin(), without.end());
  std::printf("without cache %.2f ms a frame, %.1f frames/s\n", 1e3 * best_without / frames, frames / best_without);
  std::printf("with cache    %.2f ms a frame, %.1f frames/s\n", 1e3 * best_with / frames, frames / best_with);
  std::printf("ratio         %.3f\n", best_without / best_with);
  return 0;
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() != 8) {
    std::fprintf(stderr, "usage: %s MAP RASTER LON_DEG LAT_DEG LON_DEG LAT_DEG SPACING_M ROUNDS\n", argv[0]);
    return 2;
  }
  try {
    return pilotage::run(arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_match_overlapping: %s\n", error.what());
    return 1;
  }
}
