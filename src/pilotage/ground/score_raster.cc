#include "pilotage/ground/score_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pilotage/base/error.h"
#include "pilotage/ground/measures.h"

namespace pilotage {
namespace {

/// Calls use(tile, scores) for each tile of a level.
template <class Use>
void for_each_tile(const ScoreTable& table, int level, const Use& use) {
  for (std::size_t i = 0; i < table.scores.size(); ++i) {
    if (table.ground.tiles[i].level == level) use(table.ground.tiles[i], table.scores[i]);
  }
}

/// The cells of the tiles of a level, from the first to the last column and row.
struct CellRange {
  TileCell first{std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::max()};
  TileCell last{-1, -1};

  bool empty() const { return last.row < 0; }
};

CellRange range_of(const ScoreTable& table, int level) {
  CellRange range;
  for_each_tile(table, level, [&](const GroundTile& tile, const TileScores&) {
    if (!table.ground.level_of(tile).matrix.contains(tile.column, tile.row)) {
      throw DataError("tile " + std::to_string(tile.tile_id) + " lies outside the tile matrix of level " +
                      std::to_string(level));
    }
    range.first = {std::min(range.first.column, tile.column), std::min(range.first.row, tile.row)};
    range.last = {std::max(range.last.column, tile.column), std::max(range.last.row, tile.row)};
  });
  return range;
}

template <class Value, class Get>
cv::Mat draw(const ScoreTable& table, int level, const CellRange& range, Value nothing, Get get) {
  cv::Mat values(static_cast<int>(range.last.row - range.first.row + 1),
                 static_cast<int>(range.last.column - range.first.column + 1), cv::DataType<Value>::type,
                 cv::Scalar(nothing));
  for_each_tile(table, level, [&](const GroundTile& tile, const TileScores& scores) {
    values.at<Value>(static_cast<int>(tile.row - range.first.row), static_cast<int>(tile.column - range.first.column)) =
        get(scores);
  });
  return values;
}

/// For each measure, whether some tile of the level has a number.
std::vector<char> is_measured(const ScoreTable& table, int level) {
  std::vector<char> measured(measures().size());
  for_each_tile(table, level, [&](const GroundTile&, const TileScores& scores) {
    for (std::size_t i = 0; i < measured.size(); ++i) {
      if (measured[i] == 0 && !std::isnan(measures()[i].get(scores))) measured[i] = 1;
    }
  });
  return measured;
}

}  // namespace

ScoreRaster score_raster(const ScoreTable& table, int level) {
  ScoreRaster raster;
  const CellRange range = range_of(table, level);
  if (range.empty()) return raster;
  raster.map_from_pixel = table.ground.levels[static_cast<std::size_t>(level)].matrix.map_from_stride_cell(range.first);
  const auto add_band = [&](const Measure& measure) {
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    raster.bands.push_back({measure.name, measure.unit, draw(table, level, range, kNothing, measure.get)});
  };
  add_band(coverage_measure());
  const std::vector<char> measured = is_measured(table, level);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (measured[i] != 0) add_band(measures()[i]);
  }
  return raster;
}

cv::Mat class_raster(const ScoreTable& table, int level,
                     const std::function<std::uint8_t(const TileScores&)>& class_of) {
  const CellRange range = range_of(table, level);
  if (range.empty()) return {};
  return draw(table, level, range, kNoClass, class_of);
}

}  // namespace pilotage
