// The map of a plan beside one pass of cv::ORB over the same pixels, in one run:
//   bench_build_beside_orb PLAN TABLE SELECTION THREADS REPEATS
// The plan has one level, with all tiles selected (tests/accept/whole_map.py --keep makes such files). Each repeat
// does, one after the other: pixels of the level, read and warped; cv::ORB of them, with as many features as the map
// gets; features of the map from pixels in memory; build_map, which reads, describes, writes and digests. Printed are
// best and median of the repeats and the processor time of all threads, each with its ratio to that of cv::ORB.
#include <cstdio>
#include <string>
#include <vector>

#include "bench/steps.h"
#include "testing/temporary_folder.h"
#include <opencv2/core/utility.hpp>
#include <opencv2/features2d.hpp>

#include "pilotage/base/output_file.h"
#include "pilotage/build_map/build_map.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/tile_table.h"
#include "pilotage/mission/plan_file.h"
#include "pilotage/mission/selection_file.h"
#include "pilotage/raster/gray_stretch.h"

namespace pilotage {
namespace {

void run(char** argv) {
  const Mission mission = read_plan(argv[1]);
  const Selection selection = read_selection(argv[3]);
  const int threads = std::stoi(argv[4]);
  std::vector<TileScores> scores;
  for (const TileRow& row : tile_table_from_csv(argv[2], read_file(argv[2]))) scores.push_back(row.score);
  const testing::TemporaryFolder folder;
  const BuildOptions options;
  const GridLevel& level = mission.ground.levels.front();
  Raster pixels;
  BuildStats built;
  const auto build = [&] {
    built = build_map(folder / "map.gpkg", mission, scores, selection, {}, "bench", options, true, threads);
  };
  build();
  const auto read = [&] {
    const GraySource source = stretch_to_8bit(open_gray(mission.ground, level));
    pixels = source.read({0, 0, static_cast<int>(source.width_px), static_cast<int>(source.height_px)});
  };
  cv::setNumThreads(threads);
  std::vector<Step> steps;
  steps.push_back({"pixels of the level", read});
  steps.push_back({"cv::ORB", [&] {
                     std::vector<cv::KeyPoint> keypoints;
                     cv::Mat descriptors;
                     cv::ORB::create(static_cast<int>(built.descriptors))
                         ->detectAndCompute(pixels.pixels, pixels.valid, keypoints, descriptors);
                   }});
  steps.push_back({"features of the map", [&] {
                     const GraySource source = gray_source_from(pixels);
                     extract_features_of_map(
                         source, {{0, 0, static_cast<int>(source.width_px), static_cast<int>(source.height_px)}},
                         options.features, threads);
                   }});
  steps.push_back({"build_map", build});
  measure(steps, std::stoi(argv[5]));
  std::printf("%d x %d px, %lld tiles, %lld features, %lld bytes, %d threads\n", pixels.pixels.cols, pixels.pixels.rows,
              static_cast<long long>(built.tiles), static_cast<long long>(built.descriptors),
              static_cast<long long>(built.bytes), threads);
  print(steps, 1);
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: %s PLAN TABLE SELECTION THREADS REPEATS\n", argv[0]);
    return 2;
  }
  pilotage::run(argv);
  return 0;
}
