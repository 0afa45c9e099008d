// The k nearest descriptors of 500 queries among 50,000: every path beside OpenCV's brute-force matcher.
//   build/release/bin/bench_hamming

#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>

#include "pilotage/base/random.h"
#include "pilotage/vision/hamming.h"

namespace pilotage {
namespace {

constexpr int kNeighbours = 2;
constexpr std::size_t kQueries = 500;

FeatureSet random_set(std::size_t count, int bytes, double side_px) {
  Random random(count);
  FeatureSet set;
  set.descriptor_bytes = bytes;
  for (std::size_t i = 0; i < count; ++i) {
    set.features.push_back(
        {static_cast<float>(random.uniform(0, side_px)), static_cast<float>(random.uniform(0, side_px)), 0, 0});
    for (int byte = 0; byte < bytes; ++byte) set.descriptors.push_back(static_cast<std::uint8_t>(random.below(256)));
  }
  return set;
}

void bm_opencv(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto bytes = static_cast<int>(state.range(0));
  FeatureSet map = random_set(static_cast<std::size_t>(state.range(1)), bytes, 1000);
  FeatureSet queries = random_set(kQueries, bytes, 1000);
  const cv::Mat map_rows(static_cast<int>(map.size()), bytes, CV_8UC1, map.descriptors.data());
  const cv::Mat query_rows(static_cast<int>(queries.size()), bytes, CV_8UC1, queries.descriptors.data());
  const cv::BFMatcher matcher(cv::NORM_HAMMING);
  for (auto _ : state) {
    std::vector<std::vector<cv::DMatch>> matches;
    matcher.knnMatch(query_rows, map_rows, matches, kNeighbours);
    benchmark::DoNotOptimize(matches.data());
  }
}

void bm_path(benchmark::State& state, HammingPath path) {
  const auto bytes = static_cast<int>(state.range(0));
  const auto paths = hamming_paths();
  if (std::find(paths.begin(), paths.end(), path) == paths.end()) {
    state.SkipWithError("this machine cannot run the path");
    return;
  }
  const HammingIndex index(random_set(static_cast<std::size_t>(state.range(1)), bytes, 1000));
  const FeatureSet queries = random_set(kQueries, bytes, 1000);
  for (auto _ : state) benchmark::DoNotOptimize(index.find_nearest(queries, kNeighbours, path).matches.data());
}

/// Each query looks at a quarter of the map, as with a search window half as wide as the map.
void bm_windows(benchmark::State& state) {
  const auto bytes = static_cast<int>(state.range(0));
  const HammingIndex index(random_set(static_cast<std::size_t>(state.range(1)), bytes, 1000));
  const FeatureSet queries = random_set(kQueries, bytes, 500);
  std::vector<HammingWindow> windows;
  for (const Feature& query : queries.features) {
    const double x = static_cast<double>(query.x_px);
    const double y = static_cast<double>(query.y_px);
    windows.push_back({x, y, x + 500, y + 500});
  }
  for (auto _ : state) benchmark::DoNotOptimize(index.find_nearest(queries, windows, kNeighbours).matches.data());
}

void bm_build_index(benchmark::State& state) {
  const FeatureSet map = random_set(static_cast<std::size_t>(state.range(1)), static_cast<int>(state.range(0)), 1000);
  for (auto _ : state) benchmark::DoNotOptimize(HammingIndex(map).size());
}

BENCHMARK(bm_opencv)
    ->Args({32, 50000})
    ->Args({16, 50000})
    ->Args({64, 50000})
    ->Args({32, 8000})
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_path, portable, HammingPath::kPortable)->Args({32, 50000})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_path, avx2, HammingPath::kAvx2)->Args({32, 50000})->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(bm_path, avx512, HammingPath::kAvx512)
    ->Args({32, 50000})
    ->Args({16, 50000})
    ->Args({64, 50000})
    ->Args({32, 8000})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(bm_windows)->Args({32, 8000})->Args({32, 50000})->Unit(benchmark::kMillisecond);
BENCHMARK(bm_build_index)->Args({32, 8000})->Args({32, 50000})->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pilotage
