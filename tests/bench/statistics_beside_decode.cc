// V and H of dense tiles beside what GDAL needs to read and decode the same file, in one run:
//   bench_statistics_beside_decode FILE TILE STRIDE THREADS REPEATS
// Each repeat opens the file anew and does, one after the other: GDAL alone, one data set per thread, rows of blocks;
// gray pixels of the same rows; V and H into scores that lie there; scores of all tiles; rows as for `pilotage score`;
// the score raster; the table. Printed are best and median of the repeats and the processor time of all threads, each
// with its ratio to that of GDAL alone.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "bench/steps.h"
#include "testing/temporary_folder.h"
#include <gdal_priv.h>

#include "pilotage/base/output_file.h"
#include "pilotage/base/parallel.h"
#include "pilotage/ground/ground_imagery.h"
#include "pilotage/ground/ground_of_rasters.h"
#include "pilotage/ground/score_raster.h"
#include "pilotage/raster/gdal_io.h"
#include "pilotage/score/score_ground.h"
#include "pilotage/score/tile_statistics.h"

namespace pilotage {
namespace {

struct Request {
  std::string file;
  RasterGridOptions grid;
  ScoreOptions score;
  int threads = 1;
};

using Handle = std::unique_ptr<GDALDataset>;

Handle open(const std::string& file) {
  return Handle(GDALDataset::Open(file.c_str(), GDAL_OF_RASTER | GDAL_OF_READONLY));
}

/// All bands of the file, pixel by pixel, in rows of blocks.
void decode(const Request& request) {
  std::vector<Handle> handles;
  for (int i = 0; i < request.threads; ++i) handles.push_back(open(request.file));
  GDALDataset& first = *handles.front();
  int block_width = 0;
  int block_height = 0;
  first.GetRasterBand(1)->GetBlockSize(&block_width, &block_height);
  const int rows = std::max(block_height, 64);
  const int width = first.GetRasterXSize();
  const int height = first.GetRasterYSize();
  const int bands = first.GetRasterCount();
  std::vector<std::vector<unsigned char>> buffers(handles.size());
  parallel_for(static_cast<std::size_t>((height + rows - 1) / rows), request.threads,
               [&](std::size_t index, int worker) {
                 std::vector<unsigned char>& buffer = buffers[static_cast<std::size_t>(worker)];
                 const int row = static_cast<int>(index) * rows;
                 const int count = std::min(rows, height - row);
                 buffer.resize(static_cast<std::size_t>(rows) * static_cast<std::size_t>(width * bands));
                 if (handles[static_cast<std::size_t>(worker)]->RasterIO(
                         GF_Read, 0, row, width, count, buffer.data(), width, count, GDT_Byte, bands, nullptr, bands,
                         static_cast<GSpacing>(width) * bands, 1, nullptr) != CE_None) {
                   std::exit(1);
                 }
               });
}

void read_gray(const Request& request) {
  const GraySource source = open_gray(request.file);
  const int rows = std::max(source.block_height_px, 64);
  parallel_for(static_cast<std::size_t>((source.height_px + rows - 1) / rows), request.threads,
               [&](std::size_t index, int) {
                 const std::int64_t row = static_cast<std::int64_t>(index) * rows;
                 source.read({0, row, static_cast<int>(source.width_px),
                              static_cast<int>(std::min<std::int64_t>(rows, source.height_px - row))});
               });
}

Ground open_ground(const Request& request) {
  return ground_of_rasters({request.file}, request.grid).ground;
}

/// V and H into scores that lie in memory already.
void score_into(const Request& request, std::vector<TileScores>& scores) {
  const Ground ground = open_ground(request);
  const TileMatrix& matrix = ground.levels.front().matrix;
  scores.resize(static_cast<std::size_t>(matrix.tile_count()));
  std::vector<MeasuredTile> tiles;
  for (TileScores& score : scores) tiles.push_back({matrix.cell_of(std::ssize(tiles)), &score});
  stream_statistics(open_gray(ground, ground.levels.front()), matrix, request.score, tiles, request.threads);
}

void score_in_memory(const Request& request) {
  const Ground ground = open_ground(request);
  const GridLevel& level = ground.levels.front();
  std::vector<std::int64_t> all(static_cast<std::size_t>(level.matrix.tile_count()));
  std::iota(all.begin(), all.end(), 0);
  score_tiles(open_gray(ground, level), level.matrix, 0, all, request.score, 1, request.threads);
}

void run(const Request& request, int repeats) {
  const testing::TemporaryFolder folder;
  Ground ground;
  std::vector<TileScores> scored;
  std::vector<Step> steps;
  steps.push_back({"GDAL reads and decodes", [&] { decode(request); }});
  steps.push_back({"gray pixels", [&] { read_gray(request); }});
  std::vector<TileScores> scores;
  steps.push_back({"V and H", [&] { score_into(request, scores); }});
  steps.push_back({"scores in memory", [&] { score_in_memory(request); }});
  steps.push_back({"scores with places and reasons", [&] {
                     ground = open_ground(request);
                     cut_all_tiles(ground, request.threads);
                     scored = score_ground(ground, request.score, 1, request.threads).scores;
                   }});
  steps.push_back({"score raster", [&] {
                     const ScoreRaster raster = score_raster(ScoreTable(ground, scored), 0);
                     write_score_raster(folder / "scores.tif", raster.bands, ground.crs, raster.map_from_pixel, true);
                   }});
  steps.push_back({"table", [&] { write_file(folder / "tiles.csv", tile_table_to_csv(ground, scored), true); }});
  measure(steps, repeats);
  std::printf("%zu tiles, %d threads\n", scored.size(), request.threads);
  print(steps, 0);
}

}  // namespace
}  // namespace pilotage

int main(int argc, char** argv) {
  if (argc != 6) {
    std::fprintf(stderr, "usage: %s FILE TILE STRIDE THREADS REPEATS\n", argv[0]);
    return 2;
  }
  pilotage::Request request;
  request.file = argv[1];
  request.grid.tile_size_px = std::stoi(argv[2]);
  request.grid.stride_px = std::stoi(argv[3]);
  request.grid.search_radius_px = 0;
  request.threads = std::stoi(argv[4]);
  request.score.measures = {pilotage::ScoreMeasure::kGrayVariance, pilotage::ScoreMeasure::kFriedenEntropy};
  GDALAllRegister();
  pilotage::run(request, std::stoi(argv[5]));
  return 0;
}
