#include "pilotage/score/tile_statistics.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "pilotage/base/parallel.h"
#include "pilotage/score/gray_statistics.h"

namespace pilotage {
namespace {

constexpr std::size_t kTilesAtOnce = 4096;       // one piece of work
constexpr std::int64_t kStripPixels = 16 << 20;  // of the map in memory, where a tile is not higher
constexpr std::int64_t kUnitSide_px = 256;       // least side of what is read at a time
constexpr std::int64_t kLargestBlock_px = 4096;

void set_statistics(const TileMatrix& matrix, const ScoreOptions& options, const GrayStatistics& statistics,
                    TileScore& score) {
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

/// The smallest window around tiles.
PixelWindow window_around(const TileMatrix& matrix, std::span<TileScore* const> tiles) {
  std::int64_t first_column = tiles.front()->column;
  std::int64_t last_column = first_column;
  std::int64_t first_row = tiles.front()->row;
  std::int64_t last_row = first_row;
  for (const TileScore* tile : tiles) {
    first_column = std::min(first_column, tile->column);
    last_column = std::max(last_column, tile->column);
    first_row = std::min(first_row, tile->row);
    last_row = std::max(last_row, tile->row);
  }
  const PixelWindow first = matrix.tile_window(first_column, first_row);
  const PixelWindow last = matrix.tile_window(last_column, last_row);
  return {first.col, first.row, static_cast<int>(last.col + last.width - first.col),
          static_cast<int>(last.row + last.height - first.row)};
}

cv::Rect rect_in(const PixelWindow& outer, const PixelWindow& part) {
  return {static_cast<int>(part.col - outer.col), static_cast<int>(part.row - outer.row), part.width, part.height};
}

/// What is read of a source at a time: whole blocks of its file.
struct ReadUnits {
  std::int64_t width_px = 0;
  std::int64_t height_px = 0;
  std::int64_t across = 0;
  std::vector<char> wanted;  // row by row: some tile touches it

  ReadUnits(const GraySource& source, const TileMatrix& matrix, std::span<TileScore* const> tiles)
      : width_px(source.block_width_px >= source.width_px ? source.width_px : side(source.block_width_px)),
        height_px(side(source.block_height_px)) {
    across = (source.width_px + width_px - 1) / width_px;
    wanted.resize(static_cast<std::size_t>(across * ((source.height_px + height_px - 1) / height_px)));
    for (const TileScore* tile : tiles) {
      const PixelWindow window = matrix.tile_window(tile->column, tile->row);
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

/// All columns of the map from one row to another. Rows that `above` has are not read again.
GrayWindow read_strip(const GraySource& source, const ReadUnits& units, std::int64_t first_row, std::int64_t end_row,
                      const GrayWindow& above, int threads) {
  GrayWindow strip;
  strip.window = {0, first_row, static_cast<int>(source.width_px), static_cast<int>(end_row - first_row)};
  strip.pixels.create(strip.window.height, strip.window.width, source.depth);
  strip.valid.create(strip.window.height, strip.window.width, CV_8U);
  const std::int64_t known = std::max(first_row, above.window.row + above.window.height);
  if (known > first_row) {
    const cv::Range from(static_cast<int>(first_row - above.window.row), above.window.height);
    const cv::Range to(0, static_cast<int>(known - first_row));
    above.pixels.rowRange(from).copyTo(strip.pixels.rowRange(to));
    above.valid.rowRange(from).copyTo(strip.valid.rowRange(to));
  }
  const std::int64_t first_unit = known / units.height_px * units.across;
  const std::int64_t end_unit = (end_row + units.height_px - 1) / units.height_px * units.across;
  parallel_for(static_cast<std::size_t>(end_unit - first_unit), threads, [&](std::size_t index, int) {
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

}  // namespace

void score_statistics(const GrayWindow& map, const TileMatrix& matrix, const ScoreOptions& options,
                      std::span<TileScore* const> tiles, int threads) {
  if (tiles.empty()) return;
  const PixelWindow all = window_around(matrix, tiles);
  const WindowSums sums(map.pixels(rect_in(map.window, all)), map.valid(rect_in(map.window, all)), matrix.tile_size_px,
                        matrix.stride_px, threads);
  const std::int64_t first_column = all.col / matrix.stride_px;
  const std::int64_t first_row = all.row / matrix.stride_px;
  parallel_for((tiles.size() + kTilesAtOnce - 1) / kTilesAtOnce, threads, [&](std::size_t piece, int) {
    for (TileScore* tile :
         tiles.subspan(piece * kTilesAtOnce, std::min(kTilesAtOnce, tiles.size() - piece * kTilesAtOnce))) {
      set_statistics(matrix, options, sums.at(tile->column - first_column, tile->row - first_row), *tile);
    }
  });
}

void stream_statistics(const GraySource& source, const TileMatrix& matrix, const ScoreOptions& options,
                       std::span<TileScore* const> tiles, int threads, const Progress& progress) {
  const ReadUnits units(source, matrix, tiles);
  const std::int64_t strip_rows = std::max<std::int64_t>(matrix.tile_size_px, kStripPixels / source.width_px);
  GrayWindow strip;
  for (std::size_t done = 0; done < tiles.size();) {
    report_progress(progress, "score", static_cast<std::int64_t>(done), static_cast<std::int64_t>(tiles.size()));
    const std::int64_t first_row = matrix.tile_window(0, tiles[done]->row).row;
    const std::int64_t end = (first_row + strip_rows + units.height_px - 1) / units.height_px * units.height_px;
    strip = read_strip(source, units, first_row, std::min(end, source.height_px), strip, threads);
    const auto below =
        std::find_if(tiles.begin() + static_cast<std::ptrdiff_t>(done), tiles.end(), [&](const TileScore* tile) {
          return matrix.tile_window(0, tile->row).row + matrix.tile_size_px > strip.window.row + strip.window.height;
        });
    const auto next = static_cast<std::size_t>(below - tiles.begin());
    score_statistics(strip, matrix, options, tiles.subspan(done, next - done), threads);
    done = next;
  }
  report_progress(progress, "score", static_cast<std::int64_t>(tiles.size()), static_cast<std::int64_t>(tiles.size()));
}

}  // namespace pilotage
