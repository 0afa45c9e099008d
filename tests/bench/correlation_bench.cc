// The correlation surface of a 256 px tile in its search area of ±256 px: cv::matchTemplate, one FFT for one tile, and
// the share of one tile when blocks and map windows are shared (its blocks' own work: one block, its share of the map's
// transforms, four sums). Then what is read from a surface, and what a degraded copy costs.
#include <array>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"
#include "pilotage/correlation/correlation_kernels.h"
#include "pilotage/correlation/correlation_peaks.h"
#include "pilotage/correlation/fft_correlation.h"
#include "pilotage/degradation/degradation.h"

namespace pilotage {
namespace {

constexpr int kTile = 256;
constexpr int kRadius = 256;
constexpr int kStride = 64;
constexpr int kRegion = kTile + 2 * kRadius;

cv::Mat ground(int side) {
  Random random(seed_from_name("correlation_bench"));
  cv::Mat noise(side, side, CV_32F);
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) noise.at<float>(row, col) = static_cast<float>(random.normal());
  }
  cv::Mat coarse;
  cv::GaussianBlur(noise, coarse, {0, 0}, 5);
  return 200 * coarse + 10 * noise;
}

void surface_by_match_template(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat region = ground(kRegion);
  cv::Mat bytes;
  region.convertTo(bytes, CV_8U, 1, 110);
  cv::Mat surface;
  for (auto _ : state) {
    cv::matchTemplate(bytes, bytes(cv::Rect(kRadius, kRadius, kTile, kTile)), surface, cv::TM_CCOEFF_NORMED);
    benchmark::DoNotOptimize(surface.data);
  }
}
BENCHMARK(surface_by_match_template)->Unit(benchmark::kMillisecond);

void surface_alone(benchmark::State& state) {
  const cv::Mat region = ground(kRegion);
  for (auto _ : state) {
    cv::Mat surface = correlation_surface(region(cv::Rect(kRadius, kRadius, kTile, kTile)), region);
    benchmark::DoNotOptimize(surface.data);
  }
}
BENCHMARK(surface_alone)->Unit(benchmark::kMillisecond);

/// What one tile costs when neighbours share the rest. Arguments: block side (64 px: a clean tile's share; 256 px: a
/// degraded copy) and step of the lags.
void surface_share(benchmark::State& state) {
  const auto block = static_cast<int>(state.range(0));
  const auto step = static_cast<int>(state.range(1));
  const BlockCorrelator correlator(block, kRadius, kStride, step);
  const cv::Mat map = ground(block + 2 * kRadius);
  const auto components = [step](const cv::Mat& image) {
    std::vector<cv::Mat> result;
    take_apart(image, step, result);
    return result;
  };
  std::array<RealFft2d::Workspace, 1> workspaces{correlator.make_workspace()};
  std::vector<AlignedFloats> windows;
  std::vector<const float*> pointers;
  const int parts = correlator.windows_per_side();
  const int side = correlator.window_px();
  const auto window = [&](int part) {
    return components(
        map(cv::Rect(part % parts * correlator.hop_px(), part / parts * correlator.hop_px(), side, side)));
  };
  for (int part = 0; part < parts * parts; ++part) {
    windows.emplace_back(correlator.spectrum_size());
    correlator.forward(window(part), workspaces[0], windows.back().data());
  }
  for (const AlignedFloats& spectrum : windows) pointers.push_back(spectrum.data());
  AlignedFloats own(correlator.spectrum_size());
  const std::array<const float*, 1> blocks{own.data()};
  const int positions = 2 * correlator.radius() + 1;
  std::vector<cv::Mat> surfaces;
  for (int i = 0; i < 4; ++i) surfaces.emplace_back(positions, positions, CV_32F, cv::Scalar(0));
  cv::Mat sum(positions, positions, CV_32F);
  const std::vector<cv::Mat> window_pixels = window(0);
  const std::vector<cv::Mat> block_pixels = components(map(cv::Rect(kRadius, kRadius, block, block)));
  for (auto _ : state) {
    correlator.forward(window_pixels, workspaces[0], windows[0].data());  // one new window per block
    correlator.forward(block_pixels, workspaces[0], own.data());
    correlator.correlate(blocks, pointers, {0, positions}, workspaces, {surfaces.data(), 1});
    for (int times = 0; times < (block < kTile ? 2 : 0); ++times) {  // blocks of a row, rows of a tile
      add_four(surfaces[0].ptr<float>(), surfaces[1].ptr<float>(), surfaces[2].ptr<float>(), surfaces[3].ptr<float>(),
               sum.total(), sum.ptr<float>());
    }
    benchmark::DoNotOptimize(sum.data);
  }
}
BENCHMARK(surface_share)->ArgsProduct({{64, 256}, {1, 2, 4}})->Unit(benchmark::kMillisecond);

void peaks_of_surface(benchmark::State& state) {
  const cv::Mat region = ground(kRegion);
  const cv::Mat surface = correlation_surface(region(cv::Rect(kRadius, kRadius, kTile, kTile)), region);
  for (auto _ : state) benchmark::DoNotOptimize(correlation_peaks(surface, {kRadius, kRadius}, kTile));
}
BENCHMARK(peaks_of_surface)->Unit(benchmark::kMillisecond);

void degraded_copy(benchmark::State& state) {
  cv::setNumThreads(1);
  const DegradationOptions options;
  const int margin = rotation_margin_px(kTile, options);
  const Degrader degrader(kTile, margin, options, 1, 0);
  const cv::Mat tile = ground(kTile + 2 * margin);
  for (auto _ : state) {
    cv::Mat copy = degrader.apply(tile);
    benchmark::DoNotOptimize(copy.data);
  }
}
BENCHMARK(degraded_copy)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pilotage
