// One filter of 9 × 9 cells over a picture of 640 × 480 px: the scorer that flies, and dlib's own detector; each on one
// thread, once on the picture alone and once with the four smaller copies on which twice as large landmarks are seen.

#include "landmark/dlib_detector.h"
#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"
#include "pilotage/vision/landmark_detector.h"

namespace pilotage {
namespace {

cv::Mat picture() {
  cv::Mat gray(480, 640, CV_8UC1);
  Random random(1);
  for (int row = 0; row < gray.rows; ++row) {
    for (int col = 0; col < gray.cols; ++col) {
      gray.at<std::uint8_t>(row, col) = static_cast<std::uint8_t>(random.uniform(0, 255));
    }
  }
  cv::GaussianBlur(gray, gray, {5, 5}, 1.5);
  return gray;
}

LandmarkDetector detector(int levels) {
  LandmarkDetector one;
  one.class_name = "disc";
  one.gsd_m = 1;
  one.shortest_m = one.longest_m = 35;
  one.context = 1.3;
  one.window.levels = levels;
  Random random(2);
  std::vector<float>& filter = one.filters.emplace_back();
  while (filter.size() + 1 < one.window.filter_size()) filter.push_back(static_cast<float>(0.01 * random.normal()));
  filter.push_back(10);  // nothing is found: the time is that of looking
  return one;
}

void detect(benchmark::State& state) {
  const cv::Mat gray = picture();
  const LandmarkDetector one = detector(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(detect_landmarks(one, gray, 1, 0).size());
}
BENCHMARK(detect)->Arg(1)->Arg(5)->Unit(benchmark::kMillisecond);

void detect_dlib(benchmark::State& state) {
  const cv::Mat gray = picture();
  const LandmarkDetector one = detector(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(testing::detect_by_dlib(one.filters.front(), one.window, gray, 0).size());
  }
}
BENCHMARK(detect_dlib)->Arg(1)->Arg(5)->Unit(benchmark::kMillisecond);

void cells(benchmark::State& state) {
  const cv::Mat gray = picture();
  for (auto _ : state) benchmark::DoNotOptimize(FhogCells(gray, 5, 5).rows());
}
BENCHMARK(cells)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pilotage
