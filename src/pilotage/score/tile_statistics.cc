#include "pilotage/score/tile_statistics.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <vector>

#include "pilotage/base/parallel.h"
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

/// What is read of a source at a time: whole blocks of its file.
struct ReadUnits {
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  std::int64_t across = 0;
  std::vector<char> wanted;  // row by row: some tile touches it
  ColumnRange columns;       // of the tiles

  ReadUnits(const GraySource& source, const TileMatrix& matrix, std::span<const MeasuredTile> tiles)
      : width_px(source.block_width_px >= source.width_px ? source.width_px : side(source.block_width_px)),
        height_px(side(source.block_height_px)) {
    across = (source.width_px + width_px - 1) / width_px;
    wanted.resize(static_cast<std::size_t>(across * ((source.height_px + height_px - 1) / height_px)));
    for (const MeasuredTile& tile : tiles) {
      columns.extend(tile.cell.column);
      const PixelWindow window = matrix.tile_window(tile.cell);
      for (std::int64_t row = window.row / height_px; row * height_px < window.row + window.height; ++row) {
        const std::int64_t first = window.col / width_px;
        const std::int64_t last = (window.col + window.width - 1) / width_px;
        std::fill_n(wanted.begin() + row * across + first, last - first + 1, char{1});
      }
    }
  }

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

/// All columns of the map from one row to another, in `memory`, which holds the strip above; rows that it has are not
/// read again. `checkpoint` is called again and again, by the calling thread, and may throw.
GrayWindow read_strip(const GraySource& source, const ReadUnits& units, std::int64_t first_row, std::int64_t end_row,
                      const GrayWindow& above, GrayWindow& memory, int threads,
                      const std::function<void()>& checkpoint) {
  const std::int64_t known = std::max(first_row, above.window.row + above.window.height);
  if (known > first_row) {
    move_to_top(memory.pixels, static_cast<int>(first_row - above.window.row), static_cast<int>(known - first_row));
    move_to_top(memory.valid, static_cast<int>(first_row - above.window.row), static_cast<int>(known - first_row));
  }
  GrayWindow strip;
  strip.window = {0, first_row, static_cast<int>(source.width_px), static_cast<int>(end_row - first_row)};
  strip.pixels = memory.pixels.rowRange(0, strip.window.height);
  strip.valid = memory.valid.rowRange(0, strip.window.height);
  const std::int64_t first_unit = known / units.height_px * units.across;
  const std::int64_t end_unit = (end_row + units.height_px - 1) / units.height_px * units.across;
  parallel_for(static_cast<std::size_t>(end_unit - first_unit), threads, [&](std::size_t index, int worker) {
    if (worker == 0) checkpoint();
    const std::int64_t unit = first_unit + static_cast<std::int64_t>(index);
    const std::int64_t col = unit % units.across * units.width_px;
    const std::int64_t row = std::max(known, unit / units.across * units.height_px);
    const std::int64_t end = std::min((unit / units.across + 1) * units.height_px, end_row);
    const PixelWindow window{col, row, static_cast<int>(std::min(units.width_px, source.width_px - col)),
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
  const auto count = static_cast<std::int64_t>(tiles.size());
  const ReadUnits units(source, matrix, tiles);
  const std::int64_t strip_rows = std::max<std::int64_t>(matrix.tile_size_px, kStatisticsStripPixels / source.width_px);
  const auto most_rows = static_cast<int>(std::min(source.height_px, strip_rows + units.height_px));
  const auto width = static_cast<int>(source.width_px);
  GrayWindow memory{{}, cv::Mat(most_rows, width, source.depth), cv::Mat(most_rows, width, CV_8U)};
  GrayWindow strip;
  while (!tiles.empty()) {
    const auto report = [&] {
      report_progress(progress, "score", count - static_cast<std::int64_t>(tiles.size()), count);
    };
    report();
    const std::int64_t first_row = matrix.tile_window(0, tiles.front().cell.row).row;
    const std::int64_t end = (first_row + strip_rows + units.height_px - 1) / units.height_px * units.height_px;
    strip = read_strip(source, units, first_row, std::min(end, source.height_px), strip, memory, threads, report);
    const auto below = std::partition_point(tiles.begin(), tiles.end(), [&](const MeasuredTile& tile) {
      const PixelWindow window = matrix.tile_window(0, tile.cell.row);
      return window.row + window.height <= strip.window.row + strip.window.height;
    });
    const auto inside = static_cast<std::size_t>(below - tiles.begin());
    score_sorted(strip, matrix, options, tiles.first(inside), units.columns, threads);
    tiles = tiles.subspan(inside);
  }
  report_progress(progress, "score", count, count);
}

}  // namespace pilotage
