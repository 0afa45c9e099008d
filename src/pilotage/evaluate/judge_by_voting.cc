#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>

#include <Eigen/LU>

#include "pilotage/base/error.h"
#include "pilotage/base/random.h"
#include "pilotage/camera/projection.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/evaluate/judge_tiles.h"
#include "pilotage/flightlog/frame_match.h"
#include "pilotage/geo/local_frame.h"
#include "pilotage/mapdb/parallel_reading.h"
#include "pilotage/raster/elevation.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

constexpr double kHalfFieldOfView_rad = std::numbers::pi / 6;
constexpr int kFrameOversampling = 2;  // frames are finer than maps
constexpr int kMaxFrameSidePx = 2048;
constexpr double kSearchSigmas = 3;

/// Heights for several threads, one at a time.
struct SharedElevation {
  explicit SharedElevation(const std::string& dataset) : heights(dataset) {}

  TerrainHeights terrain_below(const View& view, GeodeticPoint nadir) {
    const std::lock_guard lock(mutex);
    return terrain_under(view, nadir, heights);
  }

  std::mutex mutex;
  Elevation heights;
};

/// What the frames over all tiles share.
struct FrameSetup {
  const LevelScores& judged;
  const PlaceOnReference& place;
  GraySource other;                              ///< The other date.
  std::shared_ptr<SharedElevation> elevation{};  ///< Nothing: frames show level ground, as the map has it.
  Camera camera{};
  MatchOptions match{};
  double agl_m = 0;
  double search_radius_m = 0;
  double tolerance_m = 0;
};

Camera square_camera(int side_px) {
  Camera camera{side_px, side_px};
  camera.fx_px = camera.fy_px = side_px / 2.0 / std::tan(kHalfFieldOfView_rad);
  camera.cx_px = camera.cy_px = side_px / 2.0;
  return camera;
}

FrameSetup make_setup(const LevelScores& judged, const PlaceOnReference& place, const EvaluateOptions& options,
                      double tolerance_m) {
  if (judged.level.search_radius_px < 1)
    throw UsageError("search_radius_px = 0: there is nothing to search; at least 1");
  const double gsd_m = ground_gsd_m(judged);
  FrameSetup setup{judged, place,
                   stretch_to_8bit(open_gray(options.file, second_date_options(judged.ground.imagery.options)))};
  if (!judged.ground.elevation.empty()) {
    setup.elevation = std::make_shared<SharedElevation>(judged.ground.elevation);
  }
  setup.camera = square_camera(std::min(kFrameOversampling * judged.matrix().tile_size_px, kMaxFrameSidePx));
  setup.agl_m = judged.matrix().tile_size_px * gsd_m / 2 / std::tan(kHalfFieldOfView_rad);
  setup.search_radius_m = judged.level.search_radius_px * gsd_m;
  setup.tolerance_m = tolerance_m;
  setup.match.search_sigmas = kSearchSigmas;
  setup.match.attitude_sigma_deg = options.attitude_sigma_deg;
  setup.match.yaw_sigma_deg = options.attitude_sigma_deg;
  setup.match.height_sigma_fraction = options.height_sigma_fraction;
  setup.match.chips = options.chips;
  return setup;
}

/// Where the top of a frame must point so that its sides are those of the grid: the grid's north, from true north.
double grid_yaw_deg(const LevelScores& judged, const Eigen::Vector2d& center_map) {
  const GeoTransform& t = judged.matrix().map_from_pixel;
  const GroundPlace place = ground_place(judged.ground.crs, t, t.pixel_from_map(center_map));
  const Eigen::Vector2d up_m = place.pixel_from_enu_m.inverse() * Eigen::Vector2d(0, -1);
  return std::atan2(up_m.x(), up_m.y()) * 180 / std::numbers::pi;
}

/// A frame taken over a tile's centre, what is told of it, and the truth.
struct TileFrame {
  RenderedFrame picture;
  MatchPrior prior;
  GeodeticPoint true_nadir;   ///< On the reference.
  GeodeticPoint true_center;  ///< Likewise: the ground that the principal point shows.
};

std::optional<TileFrame> take_frame(const FrameSetup& setup, const GroundTile& tile, std::uint64_t seed) {
  Random random(derive_seed(seed, static_cast<std::uint64_t>(tile.tile_id)));
  const Eigen::Vector2d center_map = setup.judged.matrix().tile_center(tile.cell());
  TileFrame frame;
  frame.prior.attitude.yaw_deg = grid_yaw_deg(setup.judged, center_map);
  frame.prior.height_agl_m = setup.agl_m;
  frame.prior.covariance_en_m2 = isotropic_covariance_m2(setup.search_radius_m / kSearchSigmas);
  Attitude attitude = frame.prior.attitude;
  for (double* angle_deg : {&attitude.yaw_deg, &attitude.pitch_deg, &attitude.roll_deg}) {
    *angle_deg += setup.match.attitude_sigma_deg * random.normal();
  }
  const double agl_m = setup.agl_m * std::max(0.1, 1 + setup.match.height_sigma_fraction * random.normal());
  // Anywhere in the circle that the matcher's gate lets through.
  const double off_m = setup.search_radius_m * std::sqrt(random.uniform(0, 1));
  const double azimuth_rad = random.uniform(0, 2 * std::numbers::pi);
  const double east_m = off_m * std::sin(azimuth_rad);
  const double north_m = off_m * std::cos(azimuth_rad);

  const CrsTransform reference(setup.judged.ground.crs);
  const auto shown = reference.geodetic_from_map(center_map);
  const auto truth = reference.geodetic_from_map(setup.place(center_map));
  const auto in_other = shown ? CrsTransform(setup.other.crs).map_from_geodetic(*shown) : std::nullopt;
  const auto view = make_view(setup.camera, attitude, agl_m);
  if (!shown || !truth || !in_other || !view) return std::nullopt;
  const Eigen::Vector2d principal_px(setup.camera.cx_px, setup.camera.cy_px);
  const auto terrain = setup.elevation ? std::optional(setup.elevation->terrain_below(*view, *shown)) : std::nullopt;
  const auto center_m =
      terrain ? terrain_from_pixel(*view, *terrain, principal_px) : ground_from_pixel(*view, principal_px);
  if (!center_m) return std::nullopt;
  const GeoTransform& other_grid = setup.other.map_from_pixel;
  const GroundPlace over = ground_place(setup.other.crs, other_grid, other_grid.pixel_from_map(*in_other));
  frame.picture = terrain ? render_terrain_frame(setup.other, over, setup.camera, attitude, agl_m, *terrain)
                          : render_frame(setup.other, over, setup.camera, attitude, agl_m);
  const LocalFrame at_nadir(*truth);
  frame.prior.position = at_nadir.geodetic_from_enu({east_m, north_m, 0});
  frame.true_nadir = *truth;
  frame.true_center = at_nadir.geodetic_from_enu({center_m->x(), center_m->y(), 0});
  return frame;
}

TileOutcome judge(const FrameSetup& setup, std::size_t index, std::uint64_t seed, std::span<MapReader> maps) {
  TileOutcome outcome;
  outcome.tile = index;
  const auto frame = take_frame(setup, setup.judged.ground.tiles[index], seed);
  if (!frame || frame->picture.valid_fraction < kMinCoveredFraction) return outcome;
  const MatchResult result = match(frame->picture.gray, frame->prior, setup.camera, pointers_to(maps), setup.match);
  require_frame_was_tried(result, names_of(maps));
  outcome.status = match_status_name(result.status);
  outcome.evidence = result.stats.vote_peak;
  if (const auto& best = result.fix ? result.fix : result.candidate) {
    set_outcome_errors(outcome, *best, frame->true_center, frame->true_nadir);
  }
  outcome.outcome = result.fix ? outcome_of_fix(outcome.error_m, setup.tolerance_m) : Outcome::kRefused;
  return outcome;
}

}  // namespace

std::vector<TileOutcome> judge_by_voting(const LevelScores& judged, std::span<const std::size_t> tiles,
                                         const std::filesystem::path& map, const PlaceOnReference& place,
                                         const EvaluateOptions& options, double tolerance_m, std::uint64_t seed,
                                         int threads, const Progress& progress) {
  const FrameSetup setup = make_setup(judged, place, options, tolerance_m);
  std::vector<TileOutcome> outcomes(tiles.size());
  for_each_with_readers(
      open_unverified_maps({map}), tiles.size(), threads, "evaluating", progress,
      [&](std::size_t i, std::span<MapReader> maps) { outcomes[i] = judge(setup, tiles[i], seed, maps); });
  return outcomes;
}

}  // namespace pilotage
