// A frame of 154 m × 115 m at 1.2 m/px, turned by 33°, searched in ±90 m on chips under nine hypotheses: search_chips,
// and the same pictures with cv::matchTemplate(TM_CCOEFF_NORMED, mask), which knows no mask of the region.

#include "match/chip_scene.h"
#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "pilotage/match/chip_search.h"

namespace pilotage {
namespace {

constexpr double kGsd_m = 1.2;
constexpr int kGroundPx = 340;

cv::Mat ground() {
  return testing::random_ground(kGroundPx, kGroundPx, seed_from_name("chip_search_bench"));
}

ChipMosaic mosaic(bool hole) {
  ChipMosaic result = testing::mosaic_of(ground(), 0, 0, 2);
  if (hole) result.valid(cv::Rect(250, 0, 90, 120)).setTo(0);
  return result;
}

RectifiedFrame frame() {
  return testing::frame_over(ground(), {kGroundPx / 2.0, kGroundPx / 2.0}, 128, 96, 33);
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
