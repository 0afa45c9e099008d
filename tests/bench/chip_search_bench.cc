// A frame of 154 m × 115 m at 0.6 m/px, turned by 33°, searched in ±90 m on chips under nine hypotheses, and confirmed
// at one place.

#include "match/chip_scene.h"
#include <benchmark/benchmark.h>

#include "pilotage/match/chip_search.h"

namespace pilotage {
namespace {

constexpr double kGsd_m = 0.6;
constexpr int kGroundPx = 680;

cv::Mat ground() {
  return testing::random_ground(kGroundPx, kGroundPx, seed_from_name("chip_search_bench"));
}

ChipMosaic mosaic(bool hole) {
  ChipMosaic result = testing::mosaic_of(ground(), 0, 0, 2);
  if (hole) result.valid(cv::Rect(500, 0, 180, 240)).setTo(0);
  return result;
}

ChipFrame frame() {
  return make_chip_frame(testing::frame_over(ground(), {kGroundPx / 2.0, kGroundPx / 2.0}, 256, 192, 33));
}

void search(benchmark::State& state, bool hole) {
  cv::setNumThreads(1);
  const ChipMosaic map = mosaic(hole);
  const ChipFrame seen = frame();
  const auto hypotheses = chip_hypotheses(1.5, 3, 0.04, 3);
  const Eigen::Vector2d expected = map.level_from_mosaic({340, 340});
  for (auto _ : state) {
    const auto matches = search_chips(seen, map, expected, 90 / kGsd_m * map.factor, hypotheses);
    benchmark::DoNotOptimize(matches.data());
    if (matches.empty() || (matches[0].nadir_px - expected).norm() > 1) state.SkipWithError("not found");
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
  const ChipFrame seen = frame();
  ChipMatch candidate;
  candidate.nadir_px = map.level_from_mosaic({341.3, 339.2});
  for (auto _ : state) benchmark::DoNotOptimize(confirm_chip_match(seen, map, candidate, 3).ncc);
}
BENCHMARK(confirm)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace pilotage
