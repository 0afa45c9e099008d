#include "pilotage/ground/score_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "pilotage/base/error.h"

namespace pilotage {
namespace {

struct CellRange {
  std::int64_t first_column = std::numeric_limits<std::int64_t>::max();
  std::int64_t first_row = std::numeric_limits<std::int64_t>::max();
  std::int64_t last_column = -1;
  std::int64_t last_row = -1;
};

CellRange range_of(const TileMatrix& matrix, std::span<const TileRow> rows) {
  CellRange range;
  for (const TileRow& row : rows) {
    const GroundTile& tile = row.tile;
    if (tile.level != matrix.level) continue;
    if (!matrix.contains(tile.column, tile.row)) {
      throw DataError("tile " + std::to_string(tile.tile_id) + " lies outside the tile matrix of level " +
                      std::to_string(matrix.level));
    }
    range.first_column = std::min(range.first_column, tile.column);
    range.first_row = std::min(range.first_row, tile.row);
    range.last_column = std::max(range.last_column, tile.column);
    range.last_row = std::max(range.last_row, tile.row);
  }
  return range;
}

template <class Value, class Get>
cv::Mat draw(const TileMatrix& matrix, std::span<const TileRow> rows, const CellRange& range, Value nothing, Get get) {
  cv::Mat values(static_cast<int>(range.last_row - range.first_row + 1),
                 static_cast<int>(range.last_column - range.first_column + 1), cv::DataType<Value>::type,
                 cv::Scalar(nothing));
  for (const TileRow& row : rows) {
    if (row.tile.level != matrix.level) continue;
    values.at<Value>(static_cast<int>(row.tile.row - range.first_row),
                     static_cast<int>(row.tile.column - range.first_column)) = get(row);
  }
  return values;
}

template <class Get>
cv::Mat draw_scores(const TileMatrix& matrix, std::span<const TileRow> rows, const CellRange& range, Get get) {
  return draw(matrix, rows, range, std::numeric_limits<double>::quiet_NaN(), get);
}

/// For each measure, whether some tile of the level has a number.
std::vector<char> is_measured(const TileMatrix& matrix, std::span<const TileRow> rows) {
  std::vector<char> measured(measures().size());
  for (const TileRow& row : rows) {
    if (row.tile.level != matrix.level) continue;
    for (std::size_t i = 0; i < measured.size(); ++i) {
      if (measured[i] == 0 && !std::isnan(measures()[i].get(row.score))) measured[i] = 1;
    }
  }
  return measured;
}

}  // namespace

ScoreRaster score_raster(const TileMatrix& matrix, std::span<const TileRow> rows) {
  ScoreRaster raster;
  const CellRange range = range_of(matrix, rows);
  if (range.last_row < 0) return raster;
  raster.map_from_pixel = matrix.map_from_stride_cell({range.first_column, range.first_row});
  const auto add_band = [&](const Measure& measure) {
    raster.bands.push_back({measure.name, measure.unit, draw_scores(matrix, rows, range, [&](const TileRow& row) {
                              return measure.get(row.score);
                            })});
  };
  add_band(coverage_measure());
  const std::vector<char> measured = is_measured(matrix, rows);
  for (std::size_t i = 0; i < measured.size(); ++i) {
    if (measured[i] != 0) add_band(measures()[i]);
  }
  return raster;
}

cv::Mat class_raster(const TileMatrix& matrix, std::span<const TileRow> rows,
                     const std::function<std::uint8_t(const TileRow&)>& class_of) {
  const CellRange range = range_of(matrix, rows);
  if (range.last_row < 0) return {};
  return draw(matrix, rows, range, kNoClass, class_of);
}

}  // namespace pilotage
