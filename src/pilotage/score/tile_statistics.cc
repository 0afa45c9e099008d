#include "pilotage/score/tile_statistics.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "pilotage/base/parallel.h"
#include "pilotage/score/gray_statistics.h"

namespace pilotage {
namespace {

/// Integral images of power sums serve square groups of tiles of at most this side.
constexpr int kGroupSide = 640;

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

/// The smallest window around the tiles of a group.
PixelWindow window_around(const TileMatrix& matrix, const std::vector<TileScore*>& tiles) {
  PixelWindow all = matrix.tile_window(tiles.front()->column, tiles.front()->row);
  for (const TileScore* score : tiles) {
    const PixelWindow tile = matrix.tile_window(score->column, score->row);
    const std::int64_t end_col = std::max(all.col + all.width, tile.col + tile.width);
    const std::int64_t end_row = std::max(all.row + all.height, tile.row + tile.height);
    all.col = std::min(all.col, tile.col);
    all.row = std::min(all.row, tile.row);
    all.width = static_cast<int>(end_col - all.col);
    all.height = static_cast<int>(end_row - all.row);
  }
  return all;
}

cv::Rect rect_in(const PixelWindow& outer, const PixelWindow& part) {
  return {static_cast<int>(part.col - outer.col), static_cast<int>(part.row - outer.row), part.width, part.height};
}

void score_group(const GrayWindow& map, const TileMatrix& matrix, const ScoreOptions& options,
                 const std::vector<TileScore*>& tiles) {
  const PixelWindow all = window_around(matrix, tiles);
  const cv::Mat pixels = map.pixels(rect_in(map.window, all));
  const cv::Mat valid = map.valid(rect_in(map.window, all));
  const bool alone = tiles.size() == 1 && matrix.tile_size_px > kGroupSide;
  const std::optional<PowerSums> sums = alone ? std::nullopt : std::optional<PowerSums>(std::in_place, pixels, valid);
  for (TileScore* score : tiles) {
    const cv::Rect rect = rect_in(all, matrix.tile_window(score->column, score->row));
    set_statistics(matrix, options, sums ? sums->at(rect) : gray_statistics(pixels, valid), *score);
  }
}

}  // namespace

void score_statistics(const GrayWindow& map, const TileMatrix& matrix, const ScoreOptions& options,
                      std::span<TileScore* const> tiles, int threads) {
  const std::int64_t across = std::max(1, (kGroupSide - matrix.tile_size_px) / matrix.stride_px + 1);
  std::map<std::pair<std::int64_t, std::int64_t>, std::vector<TileScore*>> groups;
  for (TileScore* score : tiles) groups[{score->row / across, score->column / across}].push_back(score);
  std::vector<std::vector<TileScore*>> list;
  for (auto& [key, members] : groups) list.push_back(std::move(members));
  parallel_for(list.size(), threads, [&](std::size_t group, int) { score_group(map, matrix, options, list[group]); });
}

}  // namespace pilotage
