// One frame of 640 × 480 px that is 257 × 193 px on the map's grid, against a window of some 8,000 map features, on one
// core: match() as a whole, its steps, and beside it the pipeline of the textbook (cv::ORB with 1,500 features,
// cv::BFMatcher with the ratio test, cv::estimateAffinePartial2D). docs/benchmarks.md has the numbers.

#include <algorithm>
#include <numbers>

#include "bench/textbook_orb.h"
#include "testing/temporary_folder.h"
#include "testing/textured_map.h"
#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/match/guided_matching.h"
#include "pilotage/match/match.h"
#include "pilotage/match/pose_refinement.h"

namespace pilotage {
namespace {

constexpr int kTiles = 6;
constexpr std::size_t kCandidates = 30;  // as match()

/// All that the steps need, each made from the one before.
struct Scene {
  Scene() : ground(testing::make_textured_ground(kTiles)) {
    cv::setNumThreads(1);
    ground.camera = {640, 480, 554.26, 554.26, 320, 240};
    ground.agl_m = 111;
    FeatureOptions features;
    features.features_per_mpx = 25000;
    testing::write_textured_map(folder / "map.gpkg", ground, features);
    reader = MapReader::open_unverified(folder / "map.gpkg", 0);  // tiles are decoded for each frame
    keeping = MapReader::open_unverified(folder / "map.gpkg");
    const Attitude attitude{33, 2, -1};
    frame = testing::frame_over(ground, 3, -4, attitude, ground.agl_m).gray;
    prior = {ground.center, isotropic_covariance_m2(25), ground.agl_m * 1.01, {33.5, 1.5, -0.6}};
    rectify_options.gsd_m = 0.5;
    rectified = rectify();
    const Eigen::Vector2d middle(rectified.gray.cols / 2.0, rectified.gray.rows / 2.0);
    pivoted.grid = describe_frame_grid(rectified, {});
    pivoted.pivot_px = middle;
    for (const Feature& point : pivoted.grid.points.features) {
      const Eigen::Vector2d place(static_cast<double>(point.x_px), static_cast<double>(point.y_px));
      pivoted.radius_px = std::max(pivoted.radius_px, (place - middle).norm());
    }
    level = level_for_height(*reader, prior.height_agl_m);
    grid = *local_grid(*reader, *level, prior.position, 500);
    const Eigen::Vector2d pivot_m = rectified.ground_from_pixel(middle);
    center_px = grid.px_from_geodetic(prior.position) + Eigen::Vector2d(pivot_m.x(), -pivot_m.y()) / grid.gsd_m();
    space.half_width_px =
        (3 * largest_sigma_m(prior.covariance_en_m2) + 2 * prior.height_agl_m * std::tan(std::numbers::pi / 180)) / 0.5;
    local = read(*reader);
    space.center_px = center_px - local.reference_px;
    space.yaw_sigma_rad = std::numbers::pi / 180;
    space.scale_sigma = 0.03;
    candidates = vote_for_displacements(pivoted, local, space, kCandidates);
    const GuidedMatch best = match_guided(pivoted, local, space, {&candidates.front(), 1}).front();
    for (const GuidedPair& pair : supporting_pairs(pivoted, local, best.placement)) {
      const Eigen::Vector2d on_ground = rectified.ground_from_pixel(pair.from_pivot_px + middle);
      pairs.push_back({{on_ground.x(), on_ground.y(), -prior.height_agl_m},
                       0.5 * Eigen::Vector2d(pair.map_px.x(), -pair.map_px.y()),
                       0});
    }
    start_m = 0.5 * Eigen::Vector2d(best.placement.center_px.x(), -best.placement.center_px.y());
    const Eigen::Vector2d corner = center_px - Eigen::Vector2d::Constant(space.half_width_px + pivoted.radius_px);
    const int side = static_cast<int>(2 * (space.half_width_px + pivoted.radius_px));
    const PixelWindow window{static_cast<std::int64_t>(corner.x()), static_cast<std::int64_t>(corner.y()), side, side};
    orb_map = testing::orb_features(ground.gray.read(window).pixels, {}, testing::kOrbMapFeatures);
  }

  RectifiedFrame rectify() const {
    return ortho_rectify(frame, ground.camera, prior.attitude, prior.height_agl_m, rectify_options);
  }
  LocalMap read(MapReader& map) const {
    return read_local_map(map, *level, grid, center_px, space.half_width_px + pivoted.radius_px);
  }

  testing::TemporaryFolder folder;
  testing::TexturedGround ground;
  std::optional<MapReader> reader;
  std::optional<MapReader> keeping;  ///< The same map, with a cache.
  cv::Mat frame;
  MatchPrior prior;
  RectifyOptions rectify_options;
  RectifiedFrame rectified;
  PivotedFrame pivoted;
  const MapLevel* level = nullptr;
  LocalGrid grid;
  Eigen::Vector2d center_px;
  LocalMap local;
  SearchSpace space;
  std::vector<Candidate> candidates;
  std::vector<GroundPair> pairs;
  Eigen::Vector2d start_m;
  DescribedImage orb_map;
};

Scene& scene() {
  static Scene made;
  return made;
}

void bm_match(benchmark::State& state) {
  Scene& s = scene();
  MatchOptions options;
  options.chips = false;  // descriptors alone; the chips of this map are as fine as its pixels, which no real map's are
  MatchResult result;
  for (auto _ : state) result = match(s.frame, s.prior, s.ground.camera, *s.reader, options);
  if (result.status != MatchStatus::kFix) state.SkipWithError("no fix");
  state.counters["map_features"] = result.stats.map_features;
  state.counters["frame_points"] = result.stats.frame_features;
}

/// A map of 1.28 km to each side with as many features as the sample's, which wide windows hold as a whole.
struct WideScene {
  WideScene() : ground(testing::make_textured_ground(20)) {
    cv::setNumThreads(1);
    ground.camera = {640, 480, 554.26, 554.26, 320, 240};
    ground.agl_m = 111;
    FeatureOptions features;
    features.features_per_mpx = 9600;
    testing::write_textured_map(folder / "map.gpkg", ground, features);
    reader = MapReader::open_unverified(folder / "map.gpkg");
    frame = testing::frame_over(ground, 3, -4, {33, 2, -1}, ground.agl_m).gray;
  }

  testing::TemporaryFolder folder;
  testing::TexturedGround ground;
  std::optional<MapReader> reader;
  cv::Mat frame;
};

void bm_match_by_sigma(benchmark::State& state) {
  static WideScene s;
  MatchOptions options;
  options.chips = false;
  const MatchPrior prior{s.ground.center,
                         isotropic_covariance_m2(static_cast<double>(state.range(0))),
                         s.ground.agl_m * 1.01,
                         {33.5, 1.5, -0.6}};
  MatchResult result;
  for (auto _ : state) result = match(s.frame, prior, s.ground.camera, *s.reader, options);
  if (result.status != MatchStatus::kFix) state.SkipWithError("no fix");
  state.counters["map_features"] = result.stats.map_features;
}

void bm_rectify(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(scene().rectify().gray.data);
  state.counters["width_px"] = scene().rectified.gray.cols;
  state.counters["height_px"] = scene().rectified.gray.rows;
}

void bm_describe(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(describe_frame_grid(scene().rectified, {}).points.size());
}

void bm_read_map(benchmark::State& state) {
  Scene& s = scene();
  for (auto _ : state) benchmark::DoNotOptimize(s.read(*s.reader).features.size());
}

void bm_read_map_from_cache(benchmark::State& state) {
  Scene& s = scene();
  for (auto _ : state) benchmark::DoNotOptimize(s.read(*s.keeping).features.size());
}

void bm_vote(benchmark::State& state) {
  const Scene& s = scene();
  for (auto _ : state)
    benchmark::DoNotOptimize(vote_for_displacements(s.pivoted, s.local, s.space, kCandidates).size());
}

void bm_guided(benchmark::State& state) {
  const Scene& s = scene();
  for (auto _ : state) {
    benchmark::DoNotOptimize(match_guided(s.pivoted, s.local, s.space, s.candidates).size());
  }
  state.counters["candidates"] = static_cast<double>(s.candidates.size());
}

void bm_refine(benchmark::State& state) {
  const Scene& s = scene();
  for (auto _ : state)
    benchmark::DoNotOptimize(
        refine_pose(s.pairs, {isotropic_covariance_m2(25), 0.0175, 0.0175, 0.03}, s.start_m, s.start_m, 0.15).inliers);
  state.counters["pairs"] = static_cast<double>(s.pairs.size());
}

/// The textbook's, rectification included as in match().
void bm_textbook_orb(benchmark::State& state) {
  const Scene& s = scene();
  std::size_t features = 0;
  for (auto _ : state) {
    const RectifiedFrame rectified = s.rectify();
    const DescribedImage of_frame = testing::orb_features(rectified.gray, rectified.valid, testing::kOrbFeatures);
    features = of_frame.points_px.size();
    benchmark::DoNotOptimize(testing::place_by_orb(of_frame, s.orb_map).inliers);
  }
  state.counters["frame_features"] = static_cast<double>(features);
  state.counters["map_features"] = static_cast<double>(s.orb_map.points_px.size());
}

BENCHMARK(bm_match)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_match_by_sigma)->Arg(17)->Arg(60)->Arg(120)->Arg(200)->Arg(400)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_textbook_orb)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_rectify)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_describe)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_read_map)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_read_map_from_cache)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_vote)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_guided)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_refine)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pilotage
