// Features of a map beside one pass of cv::ORB over the same pixels, and of one frame. One thread each.
//   build/release/bin/bench_features

#include <benchmark/benchmark.h>
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"
#include "pilotage/camera/ortho_rectify.h"
#include "pilotage/vision/features.h"

namespace pilotage {
namespace {

/// Ground-like texture: noise at several scales.
cv::Mat ground(int side) {
  Random random(1);
  cv::Mat sum(side, side, CV_32FC1, cv::Scalar(128));
  for (const int cell : {2, 5, 16, 64}) {
    cv::Mat coarse(side / cell + 2, side / cell + 2, CV_32FC1);
    for (int row = 0; row < coarse.rows; ++row) {
      for (int col = 0; col < coarse.cols; ++col) coarse.at<float>(row, col) = static_cast<float>(random.normal() * 18);
    }
    cv::Mat fine;
    cv::resize(coarse, fine, sum.size(), 0, 0, cv::INTER_CUBIC);
    sum += fine;
  }
  cv::Mat gray;
  sum.convertTo(gray, CV_8U);
  return gray;
}

void bm_opencv_orb(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat gray = ground(2048);
  const auto orb = cv::ORB::create(static_cast<int>(state.range(0) * 4));
  for (auto _ : state) {
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    orb->detectAndCompute(gray, {}, keypoints, descriptors);
    benchmark::DoNotOptimize(descriptors.data);
  }
  state.counters["ms_per_Mpx"] =
      benchmark::Counter(4.194304e-3, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void bm_map(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat gray = ground(2048);
  const GraySource source = gray_source_from({gray, cv::Mat(gray.size(), CV_8UC1, cv::Scalar(255)), {}});
  FeatureOptions options;
  options.features_per_mpx = static_cast<double>(state.range(0));
  options.descriptor_bits = static_cast<int>(state.range(1));
  options.octaves = static_cast<int>(state.range(2));
  std::size_t count = 0;
  for (auto _ : state) {
    const FeatureSet set = extract_features_of_map(source, {{0, 0, 2048, 2048}}, options, 1);
    count = set.size();
    benchmark::DoNotOptimize(count);
  }
  state.counters["features"] = static_cast<double>(count);
  state.counters["ms_per_Mpx"] =
      benchmark::Counter(4.194304e-3, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

/// A frame of 4000 × 2250 px at 120 m, laid out at 0.6 m.
void bm_rectify(benchmark::State& state) {
  cv::setNumThreads(1);
  const cv::Mat frame = ground(4000).rowRange(0, 2250);
  Camera camera{4000, 2250, 2670, 2670, 2000, 1125};
  if (state.range(0) != 0) {
    camera.distortion_model = DistortionModel::kBrownConrady;
    camera.distortion = {-0.1, 0.02, 0.001, -0.0005, 0.001};
  }
  for (auto _ : state) {
    const RectifiedFrame result = ortho_rectify(frame, camera, {152, 1.5, -0.8}, 120, {.gsd_m = 0.6});
    benchmark::DoNotOptimize(result.gray.data);
  }
}

BENCHMARK(bm_opencv_orb)->Arg(20000)->Arg(5000)->Unit(benchmark::kMillisecond);
BENCHMARK(bm_map)
    ->Args({20000, 256, 1})
    ->Args({20000, 256, 4})
    ->Args({5000, 256, 1})
    ->Args({20000, 128, 1})
    ->Args({20000, 512, 1})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(bm_rectify)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pilotage
