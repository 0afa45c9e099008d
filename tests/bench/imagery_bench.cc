// Reading imagery: gray on its own grid, and warped onto a mission grid with either kernel. docs/methods/imagery.md has
// numbers. $PILOTAGE_BENCH_IMAGERY names the raster (default: a score raster of 4096 × 4096 doubles made on the spot).
#include <cstdlib>
#include <filesystem>
#include <string>

#include "testing/temporary_folder.h"
#include <benchmark/benchmark.h>

#include "pilotage/base/parallel.h"
#include "pilotage/base/random.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/raster/mission_crs.h"

namespace pilotage {
namespace {

constexpr int kWindow = 512;

const std::string& imagery() {
  static const testing::TemporaryFolder folder;
  static const std::string path = [] {
    if (const char* named = std::getenv("PILOTAGE_BENCH_IMAGERY")) return std::string(named);
    cv::Mat noise(4096, 4096, CV_64F);
    Random random(1);
    for (auto it = noise.begin<double>(); it != noise.end<double>(); ++it) *it = random.uniform();
    const std::filesystem::path made = folder / "noise.tif";
    write_score_raster(made, {{"noise", "", noise}}, Crs::from_user_input("EPSG:32633"),
                       GeoTransform::north_up(500000, 5'000'000, 0.5), false);
    return made.string();
  }();
  return path;
}

/// Reads all of a source in windows on `threads` threads.
void read_all(const GraySource& source, int threads) {
  const std::int64_t columns = (source.width_px + kWindow - 1) / kWindow;
  const std::int64_t rows = (source.height_px + kWindow - 1) / kWindow;
  parallel_for(static_cast<std::size_t>(columns * rows), threads, [&](std::size_t index, int) {
    const std::int64_t col = static_cast<std::int64_t>(index) % columns * kWindow;
    const std::int64_t row = static_cast<std::int64_t>(index) / columns * kWindow;
    const Raster raster =
        source.read({col, row, static_cast<int>(std::min<std::int64_t>(kWindow, source.width_px - col)),
                     static_cast<int>(std::min<std::int64_t>(kWindow, source.height_px - row))});
    benchmark::DoNotOptimize(raster.pixels.data);
  });
}

void set_rate(benchmark::State& state, const GraySource& source) {
  state.counters["Mpx/s"] = benchmark::Counter(
      1e-6 * static_cast<double>(source.width_px * source.height_px) * static_cast<double>(state.iterations()),
      benchmark::Counter::kIsRate);
}

void BM_OwnGrid(benchmark::State& state) {
  const GraySource source = open_gray(imagery());
  for ([[maybe_unused]] auto _ : state) read_all(source, static_cast<int>(state.range(0)));
  set_rate(state, source);
}
BENCHMARK(BM_OwnGrid)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_MissionGrid(benchmark::State& state) {
  const ImageryInfo info = inspect_imagery(imagery());
  const MissionCrs mission = choose_mission_crs({info.center}, 0);
  const Bounds bounds = imagery_bounds(info, mission.crs);
  const double gsd_m = info.gsd_x_m * static_cast<double>(state.range(0)) / 100;
  ImageryOptions options;
  options.resampling = static_cast<Resampling>(state.range(1));
  const GraySource source =
      open_gray_on_grid({imagery()}, mission.crs, GeoTransform::north_up(bounds.min_x_m, bounds.max_y_m, gsd_m),
                        static_cast<std::int64_t>(bounds.width_m() / gsd_m),
                        static_cast<std::int64_t>(bounds.height_m() / gsd_m), options);
  for ([[maybe_unused]] auto _ : state) read_all(source, 2);
  set_rate(state, source);
}
BENCHMARK(BM_MissionGrid)
    ->ArgNames({"gsd_percent", "resampling"})
    ->Args({110, static_cast<int>(Resampling::kBilinear)})
    ->Args({110, static_cast<int>(Resampling::kCubic)})
    ->Args({180, static_cast<int>(Resampling::kCubic)})
    ->Args({180, static_cast<int>(Resampling::kAverage)})
    ->Args({400, static_cast<int>(Resampling::kAverage)})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace pilotage
