#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/score/score_tiles.h"

namespace pilotage {

/// Pixels of a rectangle of the map in memory.
struct GrayWindow {
  PixelWindow window;  ///< Where they are on the grid.
  cv::Mat pixels;      ///< Gray values: CV_8U, CV_16U, CV_32F or CV_64F.
  cv::Mat valid;       ///< CV_8U, 0 where there is no ground.
};

/// A tile of a matrix, and where its scores go.
struct MeasuredTile {
  TileCell cell;
  TileScores* scores = nullptr;
};

/// Sets valid_fraction, status, and of V, H and the deficit what `options` asks for (all of them for P(correct fix)),
/// of tiles of `matrix` that lie inside the window. Tiles are computed from sums of powers that they share
/// (WindowSums). The same bytes for any number of threads and any choice and order of tiles. Throws UsageError for
/// pixels of another type.
void score_statistics(const GrayWindow& map, const TileMatrix& matrix, const ScoreOptions& options,
                      std::span<const MeasuredTile> tiles, int threads);

/// The same of tiles anywhere on the map, whose pixel grid is that of `source`: rows of tiles stream from the top to
/// the bottom, slab by slab (tiles_by_slab), and each block of
/// the source that a tile of a slab touches is read once. `tiles` ascend by row, then column. Memory: some 8 million
/// pixels and their sums, more only where a tile's height of a slab is more. Throws what reading throws; Interrupted.
void stream_statistics(const GraySource& source, const TileMatrix& matrix, const ScoreOptions& options,
                       std::span<const MeasuredTile> tiles, int threads, const Progress& progress = {});

}  // namespace pilotage
