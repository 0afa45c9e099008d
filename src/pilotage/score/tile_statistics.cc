#include "pilotage/score/tile_statistics.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

#include "pilotage/base/parallel.h"
#include "pilotage/geo/tile_groups.h"
#include "pilotage/score/gray_statistics.h"
#include "pilotage/score/map_strip.h"

namespace pilotage {
namespace {

constexpr std::size_t kTilesAtOnce = 4096;                // one piece of work
constexpr std::int64_t kStatisticsStripPixels = 8 << 20;  // of the map in memory, where a tile is not higher
constexpr std::int64_t kUnitSide_px = 256;                // least side of what is read at a time
constexpr std::int64_t kLargestBlock_px = 4096;

void set_statistics(const TileMatrix& matrix, const ScoreOptions& options, const GrayStatistics& statistics,
                    TileScores& score) {
  const double area = static_cast<double>(matrix.tile_size_px) * matrix.tile_size_px;
  score.valid_fraction = static_cast<double>(statistics.count) / area;
  if (score.valid_fraction < options.min_valid_fraction) {
    score.status = TileStatus::kTooLittleGround;
    return;
  }
  score.status = statistics.count < 2 || statistics.gray_variance == 0 ? TileStatus::kFlat : TileStatus::kScored;
  const bool model = options.measure(ScoreMeasure::kCorrectFix);
  if (model || options.measure(ScoreMeasure::kGrayVariance)) score.gray_variance = statistics.gray_variance;
  if (model || options.measure(ScoreMeasure::kFriedenEntropy)) {
    score.frieden_entropy = statistics.frieden_entropy;
    score.frieden_deficit = statistics.frieden_deficit;
  }
}

/// Columns of tiles.
struct ColumnRange {
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  std::int64_t last = 0;

  void extend(std::int64_t column) {
    first = std::min(first, column);
    last = std::max(last, column);
  }
};

/// What is read of a source at a time: whole blocks of its file, as many columns of them as tiles touch.
struct ReadUnits {
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  std::int64_t first_column = 0;  // of units
  std::int64_t across = 0;
  std::vector<char> wanted;  // row by row: some tile touches it
  ColumnRange columns;       // of the tiles
  std::int64_t end_col_px = 0;

  ReadUnits(const GraySource& source, const TileMatrix& matrix, std::span<const MeasuredTile> tiles)
      : width_px(source.block_width_px >= source.width_px ? source.width_px : side(source.block_width_px)),
        height_px(side(source.block_height_px)) {
    for (const MeasuredTile& tile : tiles) columns.extend(tile.cell.column);
    const auto last_unit_of = [&](const PixelWindow& window) { return (window.col + window.width - 1) / width_px; };
    first_column = matrix.tile_window(columns.first, 0).col / width_px;
    across = last_unit_of(matrix.tile_window(columns.last, 0)) + 1 - first_column;
    end_col_px = std::min(source.width_px, (first_column + across) * width_px);
    wanted.resize(static_cast<std::size_t>(across * ((source.height_px + height_px - 1) / height_px)));
    for (const MeasuredTile& tile : tiles) {
      const PixelWindow window = matrix.tile_window(tile.cell);
      for (std::int64_t row = window.row / height_px; row * height_px < window.row + window.height; ++row) {
        const std::int64_t first = window.col / width_px;
        std::fill_n(wanted.begin() + row * across + first - first_column, last_unit_of(window) - first + 1, char{1});
      }
    }
  }

  std::int64_t first_col_px() const { return first_column * width_px; }
  int strip_width_px() const { return static_cast<int>(end_col_px - first_col_px()); }

 private:
  static std::int64_t side(std::int64_t block_px) {
    if (block_px > kLargestBlock_px) return kUnitSide_px;  // as good as not in blocks, and memory counts
    return (kUnitSide_px + block_px - 1) / block_px * block_px;
  }
};

/// Moves rows of an image that fills its memory to the top of it.
void move_to_top(cv::Mat& image, int first_row, int rows) {
  std::memmove(image.ptr(0), image.ptr(first_row), static_cast<std::size_t>(rows) * image.step[0]);
}

/// The units' columns of the map from one row to another, in `memory`, which holds the strip above; rows that it has
/// are not read again. `checkpoint` is called again and again, by the calling thread, and may throw.
GrayWindow read_strip(const GraySource& source, const ReadUnits& units, std::int64_t first_row, std::int64_t end_row,
                      const GrayWindow& above, GrayWindow& memory, int threads,
                      const std::function<void()>& checkpoint) {
  const std::int64_t known = std::max(first_row, above.window.row + above.window.height);
  if (known > first_row) {
    move_to_top(memory.pixels, static_cast<int>(first_row - above.window.row), static_cast<int>(known - first_row));
    move_to_top(memory.valid, static_cast<int>(first_row - above.window.row), static_cast<int>(known - first_row));
  }
  GrayWindow strip;
  strip.window = {units.first_col_px(), first_row, units.strip_width_px(), static_cast<int>(end_row - first_row)};
  strip.pixels = memory.pixels.rowRange(0, strip.window.height);
  strip.valid = memory.valid.rowRange(0, strip.window.height);
  const std::int64_t first_unit = known / units.height_px * units.across;
  const std::int64_t end_unit = (end_row + units.height_px - 1) / units.height_px * units.across;
  parallel_for(static_cast<std::size_t>(end_unit - first_unit), threads, [&](std::size_t index, int worker) {
    if (worker == 0) checkpoint();
    const std::int64_t unit = first_unit + static_cast<std::int64_t>(index);
    const std::int64_t col = units.first_col_px() + unit % units.across * units.width_px;
    const std::int64_t row = std::max(known, unit / units.across * units.height_px);
    const std::int64_t end = std::min((unit / units.across + 1) * units.height_px, end_row);
    const PixelWindow window{col, row, static_cast<int>(std::min(units.width_px, units.end_col_px - col)),
                             static_cast<int>(end - row)};
    const cv::Rect place = rect_in(strip.window, window);
    if (units.wanted[static_cast<std::size_t>(unit)] == 0) {
      strip.pixels(place).setTo(0);
      strip.valid(place).setTo(0);
      return;
    }
    const Raster raster = source.read(window);
    raster.pixels.copyTo(strip.pixels(place));
    raster.valid.copyTo(strip.valid(place));
  });
  return strip;
}

/// Statistics of tiles, which ascend by row and stand in these columns.
void score_sorted(const GrayWindow& map, const TileMatrix& matrix, const ScoreOptions& options,
                  std::span<const MeasuredTile> tiles, const ColumnRange& columns, int threads) {
  const std::int64_t first_row = tiles.front().cell.row;
  const PixelWindow first = matrix.tile_window(columns.first, first_row);
  const PixelWindow last = matrix.tile_window(columns.last, tiles.back().cell.row);
  const cv::Rect place = rect_in(map.window, {first.col, first.row, static_cast<int>(last.col + last.width - first.col),
                                              static_cast<int>(last.row + last.height - first.row)});
  const WindowSums sums(map.pixels(place), map.valid(place), matrix.tile_size_px, matrix.stride_px, threads);
  parallel_for((tiles.size() + kTilesAtOnce - 1) / kTilesAtOnce, threads, [&](std::size_t piece, int) {
    const std::size_t begin = piece * kTilesAtOnce;
    for (const MeasuredTile& tile : tiles.subspan(begin, std::min(kTilesAtOnce, tiles.size() - begin))) {
      set_statistics(matrix, options, sums.at(tile.cell.column - columns.first, tile.cell.row - first_row),
                     *tile.scores);
    }
  });
}

/// Statistics of tiles, from the top to the bottom of their columns. `report`, told how many of them are done, may
/// throw.
void stream_columns(const GraySource& source, const TileMatrix& matrix, const ScoreOptions& options,
                    std::span<const MeasuredTile> tiles, int threads, const std::function<void(std::int64_t)>& report) {
  const auto count = std::ssize(tiles);
  const ReadUnits units(source, matrix, tiles);
  const int width = units.strip_width_px();
  const std::int64_t strip_rows = std::max<std::int64_t>(matrix.tile_size_px, kStatisticsStripPixels / width);
  const auto most_rows = static_cast<int>(std::min(source.height_px, strip_rows + units.height_px));
  GrayWindow memory{{}, cv::Mat(most_rows, width, source.depth), cv::Mat(most_rows, width, CV_8U)};
  GrayWindow strip;
  while (!tiles.empty()) {
    const auto checkpoint = [&] { report(count - std::ssize(tiles)); };
    checkpoint();
    const std::int64_t first_row = matrix.tile_window(0, tiles.front().cell.row).row;
    const std::int64_t end = (first_row + strip_rows + units.height_px - 1) / units.height_px * units.height_px;
    strip = read_strip(source, units, first_row, std::min(end, source.height_px), strip, memory, threads, checkpoint);
    const auto below = std::partition_point(tiles.begin(), tiles.end(), [&](const MeasuredTile& tile) {
      const PixelWindow window = matrix.tile_window(0, tile.cell.row);
      return window.row + window.height <= strip.window.row + strip.window.height;
    });
    const auto inside = static_cast<std::size_t>(below - tiles.begin());
    score_sorted(strip, matrix, options, tiles.first(inside), units.columns, threads);
    tiles = tiles.subspan(inside);
  }
}

}  // namespace

void score_statistics(const GrayWindow& map, const TileMatrix& matrix, const ScoreOptions& options,
                      std::span<const MeasuredTile> tiles, int threads) {
  if (tiles.empty()) return;
  std::vector<MeasuredTile> sorted(tiles.begin(), tiles.end());
  std::sort(sorted.begin(), sorted.end(),
            [](const MeasuredTile& a, const MeasuredTile& b) { return a.cell.row < b.cell.row; });
  ColumnRange columns;
  for (const MeasuredTile& tile : tiles) columns.extend(tile.cell.column);
  score_sorted(map, matrix, options, sorted, columns, threads);
}

void stream_statistics(const GraySource& source, const TileMatrix& matrix, const ScoreOptions& options,
                       std::span<const MeasuredTile> tiles, int threads, const Progress& progress) {
  std::vector<std::int64_t> indices;
  for (const MeasuredTile& tile : tiles) indices.push_back(matrix.index_of(tile.cell.column, tile.cell.row));
  std::int64_t done = 0;
  for (const std::vector<std::size_t>& places : tiles_by_slab(matrix, indices, source.block_width_px)) {
    std::vector<MeasuredTile> slab;
    for (const std::size_t place : places) slab.push_back(tiles[place]);
    stream_columns(source, matrix, options, slab, threads, [&](std::int64_t of_slab) {
      report_progress(progress, "score", done + of_slab, std::ssize(tiles));
    });
    done += std::ssize(slab);
  }
  report_progress(progress, "score", done, done);
}

}  // namespace pilotage
