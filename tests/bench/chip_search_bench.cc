// A frame of 154 m × 115 m at 1.2 m/px, turned by 33°, searched in ±90 m on chips under nine hypotheses: search_chips,
// and the same pictures with cv::matchTemplate(TM_CCOEFF_NORMED, mask), which knows no mask of the region.

#include <cmath>

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/base/random.h"
#include "pilotage/match/chip_search.h"

namespace pilotage {
namespace {

constexpr double kGsd_m = 1.2;
constexpr int kGroundPx = 340;

cv::Mat ground() {
  Random random(seed_from_name("chip_search_bench"));
  cv::Mat noise(kGroundPx, kGroundPx, CV_32F);
  for (auto it = noise.begin<float>(); it != noise.end<float>(); ++it) *it = static_cast<float>(random.normal());
  cv::Mat fine;
  cv::Mat coarse;
  cv::GaussianBlur(noise, fine, {}, 1.0);
  cv::GaussianBlur(noise, coarse, {}, 8.0);
  cv::Mat gray;
  cv::Mat(110 + 60 * fine + 300 * coarse).convertTo(gray, CV_8U);
  return gray;
}

ChipMosaic mosaic(bool hole) {
  ChipMosaic result;
  result.gray = ground();
  result.valid = cv::Mat(result.gray.size(), CV_8UC1, cv::Scalar(255));
  result.factor = 2;
  if (hole) result.valid(cv::Rect(250, 0, 90, 120)).setTo(0);
  return result;
}

// A frame in the middle of the ground, its nadir point at the middle of its picture.
RectifiedFrame frame() {
  RectifiedFrame result;
  result.status = RectifyStatus::kOk;
  const cv::Rect window(90, 90, 160, 160);
  result.gray = ground()(window).clone();
  result.valid = cv::Mat::zeros(result.gray.size(), CV_8UC1);
  cv::Point2f corners[4];
  cv::RotatedRect(cv::Point2f(80, 80), cv::Size2f(128, 96), 33).points(corners);
  std::vector<cv::Point> outline(corners, corners + 4);
  cv::fillConvexPoly(result.valid, outline, cv::Scalar(255));
  result.gray.setTo(0, result.valid == 0);
  result.gsd_m = kGsd_m;
  result.origin_m = {-80 * kGsd_m, 80 * kGsd_m};
  return result;
}

void search(benchmark::State& state, bool hole) {
  cv::setNumThreads(1);
  const ChipMosaic map = mosaic(hole);
  const RectifiedFrame seen = frame();
  const auto hypotheses = chip_hypotheses(1.5, 3, 0.04, 3);
  const Eigen::Vector2d expected = map.level_from_mosaic({170, 170});
  for (auto _ : state) {
    const ChipMatch match = search_chips(seen, map, expected, 90 / kGsd_m * map.factor, hypotheses);
    benchmark::DoNotOptimize(match.ncc);
    if (!match.found || (match.nadir_px - expected).norm() > 1) state.SkipWithError("not found");
  }
}
void search_whole(benchmark::State& state) {
  search(state, false);
}
void search_with_hole(benchmark::State& state) {
  search(state, true);
}
BENCHMARK(search_whole)->Unit(benchmark::kMillisecond);
BENCHMARK(search_with_hole)->Unit(benchmark::kMillisecond);

void confirm(benchmark::State& state) {
  cv::setNumThreads(1);
  const ChipMosaic map = mosaic(false);
  const RectifiedFrame seen = frame();
  ChipMatch candidate;
  candidate.nadir_px = map.level_from_mosaic({171.3, 169.2});
  for (auto _ : state) benchmark::DoNotOptimize(confirm_chip_match(seen, map, candidate, 3).ncc);
}
BENCHMARK(confirm)->Unit(benchmark::kMillisecond);

// One hypothesis of the nine, and no turning or scaling of the frame.
void match_template_masked(benchmark::State& state) {
  cv::setNumThreads(1);
  cv::Mat region;
  cv::Mat pixels;
  cv::Mat mask;
  const RectifiedFrame seen = frame();
  mosaic(false).gray(cv::Rect(15, 15, 310, 310)).convertTo(region, CV_32F);
  seen.gray.convertTo(pixels, CV_32F);
  seen.valid.convertTo(mask, CV_32F, 1.0 / 255);
  cv::Mat surface;
  for (auto _ : state) {
    cv::matchTemplate(region, pixels, surface, cv::TM_CCOEFF_NORMED, mask);
    benchmark::DoNotOptimize(surface.data);
  }
}
BENCHMARK(match_template_masked)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pilotage
