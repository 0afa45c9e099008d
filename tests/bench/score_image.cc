// Scores one image file and says how long it took, to be set beside another program's time on the same file:
//   bench_score_image IMAGE TILE STRIDE RADIUS THREADS MEASURE...
// The first positional numbers are in pixels; measures are those of ScoreOptions. Reading and decoding are in the
// total.
#include <chrono>
#include <cstdio>
#include <numeric>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "pilotage/score/score_tiles.h"

int main(int argc, char** argv) {
  using Clock = std::chrono::steady_clock;
  const auto seconds = [](Clock::time_point from) {
    return std::chrono::duration<double>(Clock::now() - from).count();
  };
  if (argc < 7) {
    std::fprintf(stderr, "usage: %s IMAGE TILE STRIDE RADIUS THREADS MEASURE...\n", argv[0]);
    return 2;
  }
  const auto start = Clock::now();
  pilotage::Raster raster;
  raster.pixels = cv::imread(argv[1], cv::IMREAD_GRAYSCALE);
  if (raster.pixels.empty()) {
    std::fprintf(stderr, "%s cannot be read\n", argv[1]);
    return 1;
  }
  raster.valid = cv::Mat(raster.pixels.size(), CV_8U, cv::Scalar(255));
  const double read_s = seconds(start);

  pilotage::ScoreOptions options;
  options.measures.clear();
  for (int i = 6; i < argc; ++i) {
    for (const auto& [value, name] : enum_names(pilotage::ScoreMeasure{})) {
      if (name == argv[i]) options.measures.push_back(value);
    }
  }
  const auto source = gray_source_from(raster);
  const pilotage::TileMatrix matrix{
      0, source.map_from_pixel, source.width_px, source.height_px, std::stoi(argv[2]), std::stoi(argv[3])};
  std::vector<std::int64_t> tiles(static_cast<std::size_t>(matrix.tile_count()));
  std::iota(tiles.begin(), tiles.end(), 0);
  const auto scores = score_tiles(source, matrix, std::stoi(argv[4]), tiles, options, 1, std::stoi(argv[5]));
  double checksum = 0;
  for (const auto& score : scores) {
    for (const double value : {score.frieden_entropy, score.clean.margin, score.degraded.margin}) {
      if (value == value) checksum += value;
    }
  }
  std::printf("tiles %zu read %.2f total %.2f s checksum %.17g\n", scores.size(), read_s, seconds(start), checksum);
  return 0;
}
