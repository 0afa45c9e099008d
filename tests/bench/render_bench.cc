// Frames computed over an elevation model: what sampling the ground costs beside the plain way, sample by sample, and a
// whole frame of 640 × 360 pixels, a quarter finer than the ground. docs/methods/rendered-flights.md has numbers.
#include <cmath>
#include <vector>

#include "camera/plain_sampling.h"
#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include "pilotage/base/random.h"
#include "pilotage/camera/render_frame.h"
#include "pilotage/camera/sampled_ground.h"

namespace pilotage {
namespace {

constexpr int kWidth_px = 640;
constexpr int kHeight_px = 360;
constexpr double kSide_px = 0.8;

const Raster& ground() {
  static const Raster raster = [] {
    Random random(1);
    Raster made{cv::Mat(800, 1000, CV_8UC1), cv::Mat(800, 1000, CV_8UC1, cv::Scalar(255)),
                GeoTransform::north_up(500000, 5'000'000, 0.3)};
    for (auto gray = made.pixels.begin<std::uint8_t>(); gray != made.pixels.end<std::uint8_t>(); ++gray) {
      *gray = static_cast<std::uint8_t>(256 * random.uniform());
    }
    return made;
  }();
  return raster;
}

CornerLine line(int row) {
  CornerLine corners;
  for (int col = 0; col <= kWidth_px; ++col) {
    corners.x_px.push_back(200 + kSide_px * col + 0.01 * row);
    corners.y_px.push_back(200 + kSide_px * row + 0.02 * col);
  }
  return corners;
}

void BM_SampleRow(benchmark::State& state) {
  const SampledGround sampled(ground());
  const CornerLine above = line(0);
  const CornerLine below = line(1);
  std::vector<double> means(kWidth_px);
  for ([[maybe_unused]] auto _ : state) {
    sampled.means_between(above, below, means);
    benchmark::DoNotOptimize(means.data());
  }
}
BENCHMARK(BM_SampleRow)->Unit(benchmark::kMicrosecond);

void BM_SampleRowPlainly(benchmark::State& state) {
  const CornerLine above = line(0);
  const CornerLine below = line(1);
  std::vector<double> means(kWidth_px);
  for ([[maybe_unused]] auto _ : state) {
    for (std::size_t i = 0; i < means.size(); ++i) {
      const auto corner = [i](const CornerLine& of, std::size_t right) {
        return Eigen::Vector2d(of.x_px[i + right], of.y_px[i + right]);
      };
      means[i] = testing::plain_mean(ground(), corner(above, 0), corner(above, 1), corner(below, 0), corner(below, 1));
    }
    benchmark::DoNotOptimize(means.data());
  }
}
BENCHMARK(BM_SampleRowPlainly)->Unit(benchmark::kMicrosecond);

/// `state.range(0)`: metres by which hills of 150 m stand above and below their mean.
void BM_Frame(benchmark::State& state) {
  Camera camera;
  camera.width_px = kWidth_px;
  camera.height_px = kHeight_px;
  camera.fx_px = camera.fy_px = 427;
  camera.cx_px = kWidth_px / 2.0;
  camera.cy_px = kHeight_px / 2.0;
  const double agl_m = kSide_px * 0.3 * camera.fx_px;
  const Attitude attitude{20, 1, -2};
  const auto view = make_view(camera, attitude, agl_m);
  const double hills_m = static_cast<double>(state.range(0));
  const TerrainHeights terrain = sample_terrain(
      *view, 5, [&](const Eigen::Vector2d& p) { return hills_m * std::sin(p.x() * 0.042) * std::cos(p.y() * 0.042); });
  const std::vector<Eigen::Vector3d> rays = corner_rays(camera);
  const GraySource source = gray_source_from(ground());
  GroundPlace place;
  place.nadir_px = {500, 400};
  place.pixel_from_enu_m = Eigen::Vector2d(1 / 0.3, -1 / 0.3).asDiagonal();
  for ([[maybe_unused]] auto _ : state) {
    const RenderedFrame frame = render_terrain_frame(source, place, camera, attitude, agl_m, terrain, &rays);
    benchmark::DoNotOptimize(frame.gray.data);
  }
}
BENCHMARK(BM_Frame)->Arg(0)->Arg(10)->Arg(30)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pilotage
