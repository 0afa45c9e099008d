// Time and correct fixes of match() and of the textbook's pipeline (textbook_orb.h) over the same frames, on one core.
//
//   bench_match_beside_orb MAP.gpkg RASTER frames.csv camera.yaml
//
// MAP.gpkg is a map of RASTER (tests/accept/whole_map.py), frames.csv has the truth of the picture's centre. Both get
// the frame rectified with the prior's attitude and height at the map's pixel size. ORB's 8,000 features of the raster
// in the same search window are computed beforehand, as a map would have them; its pipeline refuses nothing, so that
// its correct fixes are all it could have. docs/benchmarks.md has results.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "bench/textbook_orb.h"
#include <opencv2/core.hpp>

#include "pilotage/base/error.h"
#include "pilotage/base/output_file.h"
#include "pilotage/camera/camera_file.h"
#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/camera/projection.h"
#include "pilotage/flightlog/frame_match.h"
#include "pilotage/geo/geodesic.h"
#include "pilotage/match/local_map.h"
#include "pilotage/match/match.h"
#include "pilotage/mission/frame_table.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr double kCorrect_m = 5;

/// What one pipeline did with all frames.
struct Tally {
  int answers = 0;
  int correct = 0;
  std::vector<double> milliseconds;

  void add(const std::optional<GeodeticPoint>& center, GeodeticPoint truth) {
    if (!center) return;
    ++answers;
    if (geodesic_between(*center, truth).length_m <= kCorrect_m) ++correct;
  }
  void print(const char* name, std::size_t frames) {
    std::sort(milliseconds.begin(), milliseconds.end());
    double sum = 0;
    for (const double value : milliseconds) sum += value;
    const auto count = static_cast<double>(frames);
    std::printf("%-22s %5d answers, %5d within %.0f m (%.1f %% of %zu frames); ms a frame: median %.1f, mean %.1f\n",
                name, answers, correct, kCorrect_m, 100 * correct / count, frames,
                milliseconds[milliseconds.size() / 2], sum / count);
  }
};

double milliseconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The raster in the search window, on the grid of the map's level.
struct OrbMap {
  DescribedImage features;
  LocalGrid grid;
  Eigen::Vector2d corner_px;
};

OrbMap orb_map(const GraySource& raster, const LocalGrid& grid, const MatchPrior& prior, double reach_m) {
  OrbMap map;
  map.grid = grid;
  const Eigen::Vector2d middle = grid.px_from_geodetic(prior.position);
  const double half = reach_m / grid.gsd_m();
  const auto clamp = [](double value, std::int64_t size) {
    return static_cast<std::int64_t>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  const std::int64_t left = clamp(middle.x() - half, raster.width_px);
  const std::int64_t top = clamp(middle.y() - half, raster.height_px);
  const PixelWindow window{left, top, static_cast<int>(clamp(middle.x() + half, raster.width_px) - left),
                           static_cast<int>(clamp(middle.y() + half, raster.height_px) - top)};
  map.corner_px = {static_cast<double>(left), static_cast<double>(top)};
  if (window.width < 1 || window.height < 1) return map;
  const Raster pixels = raster.read(window);
  map.features = testing::orb_features(pixels.pixels, pixels.valid, testing::kOrbMapFeatures);
  return map;
}

std::optional<GeodeticPoint> center_by_orb(const cv::Mat& frame, const MatchPrior& prior, const Camera& camera,
                                           const OrbMap& map) {
  Attitude on_grid = prior.attitude;
  on_grid.yaw_deg -= map.grid.convergence_deg();
  RectifyOptions options;
  options.gsd_m = map.grid.gsd_m();
  const RectifiedFrame rectified = ortho_rectify(frame, camera, on_grid, prior.height_agl_m, options);
  if (rectified.status != RectifyStatus::kOk) return std::nullopt;
  const SimilarityFit fit = testing::place_by_orb(
      testing::orb_features(rectified.gray, rectified.valid, testing::kOrbFeatures), map.features);
  const auto view = make_view(camera, on_grid, prior.height_agl_m);
  const auto center_m = view ? ground_from_pixel(*view, {camera.cx_px, camera.cy_px}) : std::nullopt;
  if (fit.inliers < 4 || !center_m) return std::nullopt;
  return map.grid.geodetic_from_px(map.corner_px + fit.reference_from_frame_px(rectified.pixel_from_ground(*center_m)));
}

void measure(const std::string& map_path, const std::string& raster_path, const std::string& table_path,
             const std::string& camera_path) {
  MapReader reader = MapReader::open_unverified(map_path);
  const MapLevel& level = reader.levels().front();
  const Crs crs = Crs::from_user_input(reader.info().crs.wkt);
  const GraySource raster = stretch_to_8bit(open_gray_on_grid({raster_path}, crs, level.matrix.map_from_pixel,
                                                              level.matrix.grid_width_px, level.matrix.grid_height_px));
  const FrameTable table = frame_table_from_csv(table_path, read_file(table_path));
  const Camera given = read_camera_file(camera_path);
  const MatchOptions options;
  Tally ours;
  Tally aircraft;
  Tally best_places;
  Tally orb;
  std::size_t frames = 0;
  for (const FrameRecord& record : table.frames) {
    if (!record.true_center) continue;  // what ORB finds: it says nothing of tilt
    ++frames;
    const cv::Mat frame = read_gray8_picture(frame_path(table_path, record.file));
    const Camera camera = camera_for_size(record.file, given, frame.cols, frame.rows);
    const MatchPrior prior{record.prior, record.prior_covariance_en_m2, record.height_agl_m, record.attitude};
    auto start = std::chrono::steady_clock::now();
    const MatchResult result = match(frame, prior, camera, reader, options);
    ours.milliseconds.push_back(milliseconds_since(start));
    best_places.milliseconds.push_back(ours.milliseconds.back());
    ours.add(result.fix ? std::optional(result.fix->center) : std::nullopt, *record.true_center);
    if (record.true_nadir) {
      aircraft.milliseconds.push_back(ours.milliseconds.back());
      aircraft.add(result.fix ? std::optional(result.fix->position) : std::nullopt, *record.true_nadir);
    }
    best_places.add(result.candidate ? std::optional(result.candidate->center) : std::nullopt, *record.true_center);

    const auto grid = local_grid(reader, level, prior.position, 1000);
    if (!grid) continue;
    const double corner_m = std::hypot(camera.width_px / camera.fx_px, camera.height_px / camera.fy_px) / 2;
    const OrbMap map =
        orb_map(raster, *grid, prior,
                options.search_sigmas * largest_sigma_m(prior.covariance_en_m2) + corner_m * prior.height_agl_m);
    start = std::chrono::steady_clock::now();
    const auto center = center_by_orb(frame, prior, camera, map);
    orb.milliseconds.push_back(milliseconds_since(start));
    orb.add(center, *record.true_center);
  }
  if (frames == 0 || orb.milliseconds.empty()) throw DataError(table_path + ": no frame with truth on the map");
  ours.print("match()", frames);
  best_places.print("match(), refused too", frames);
  if (!aircraft.milliseconds.empty()) aircraft.print("match(), aircraft", aircraft.milliseconds.size());
  orb.print("ORB, ratio, RANSAC", frames);
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  try {
    if (argc != 5) throw pilotage::UsageError("bench_match_beside_orb MAP.gpkg RASTER frames.csv camera.yaml");
    cv::setNumThreads(1);
    pilotage::measure(argv[1], argv[2], argv[3], argv[4]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_match_beside_orb: %s\n", error.what());
    return 1;
  }
  return 0;
}
