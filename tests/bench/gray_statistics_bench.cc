// V and H of one 256 px window: from sums of powers, and by two passes over the pixels.
#include <benchmark/benchmark.h>

#include "pilotage/base/random.h"
#include "pilotage/score/gray_statistics.h"

namespace pilotage {
namespace {

constexpr int kTile = 256;

cv::Mat image(int type) {
  Random random(seed_from_name("gray_statistics_bench"));
  cv::Mat gray(1024, 1024, type);
  for (int row = 0; row < gray.rows; ++row) {
    for (int col = 0; col < gray.cols; ++col) {
      if (type == CV_8U) gray.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>(40 + random.below(150));
      if (type == CV_16U) gray.at<std::uint16_t>(row, col) = static_cast<std::uint16_t>(4000 + random.below(15000));
    }
  }
  return gray;
}

void from_sums(benchmark::State& state) {
  const cv::Mat gray = image(static_cast<int>(state.range(0)));
  const WindowSums sums(gray, cv::Mat(gray.size(), CV_8U, cv::Scalar(255)), kTile, static_cast<int>(state.range(1)));
  const auto columns = static_cast<std::size_t>(sums.columns());
  std::size_t i = 0;
  for (auto _ : state) {
    ++i;
    benchmark::DoNotOptimize(
        sums.at(static_cast<std::int64_t>(i * 37 % columns), static_cast<std::int64_t>(i * 101 % columns)));
  }
}
BENCHMARK(from_sums)->ArgNames({"depth", "stride"})->ArgsProduct({{CV_8U, CV_16U}, {1, 8}});

void from_pixels(benchmark::State& state) {
  const cv::Mat gray = image(static_cast<int>(state.range(0)));
  const cv::Mat valid(kTile, kTile, CV_8U, cv::Scalar(255));
  std::size_t i = 0;
  for (auto _ : state) {
    ++i;
    const cv::Rect window(static_cast<int>(i * 37 % (1024 - kTile)), static_cast<int>(i * 101 % (1024 - kTile)), kTile,
                          kTile);
    benchmark::DoNotOptimize(gray_statistics(gray(window), valid));
  }
}
BENCHMARK(from_pixels)->ArgName("depth")->Arg(CV_8U)->Arg(CV_16U);

void make_sums(benchmark::State& state) {
  const cv::Mat gray = image(static_cast<int>(state.range(0)));
  const cv::Mat valid(gray.size(), CV_8U, cv::Scalar(255));
  for (auto _ : state) {
    benchmark::DoNotOptimize(WindowSums(gray, valid, kTile, static_cast<int>(state.range(1))));
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations()) * 1024 * 1024);
}
BENCHMARK(make_sums)
    ->ArgNames({"depth", "stride"})
    ->ArgsProduct({{CV_8U, CV_16U}, {1, 8, 64}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pilotage
