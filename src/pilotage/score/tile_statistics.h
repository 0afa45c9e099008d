#pragma once

#include <span>

#include <opencv2/core/mat.hpp>

#include "pilotage/geo/tile_matrix.h"
#include "pilotage/mission/tile_scores.h"
#include "pilotage/score/score_tiles.h"

namespace pilotage {

/// Pixels of a rectangle of the map in memory.
struct GrayWindow {
  PixelWindow window;  ///< Where they are on the grid.
  cv::Mat pixels;      ///< Gray values: CV_8U, CV_16U, CV_32F or CV_64F.
  cv::Mat valid;       ///< CV_8U, 0 where there is no ground.
};

/// Sets valid_fraction, status, and of V, H and the deficit what `options` asks for (all of them for P(correct fix)),
/// of tiles of `matrix` that lie inside the window; column and row of each say which tile it is. Tiles are computed
/// from integral images of power sums, which groups of neighbours share (gray_statistics.h). The same bytes for any
/// number of threads and any choice and order of tiles. Throws UsageError for pixels of another type.
void score_statistics(const GrayWindow& map, const TileMatrix& matrix, const ScoreOptions& options,
                      std::span<TileScore* const> tiles, int threads);

}  // namespace pilotage
