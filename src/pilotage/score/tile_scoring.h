#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/degradation/degradation.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/ground/tile_scores.h"
#include "pilotage/matchability/matchability_model.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/score/score_tiles.h"

namespace pilotage {

/// What the scoring of a map knows before its first tile, for tiles that are scored in several calls.
struct TileScoring {
  const GraySource& source;
  const TileMatrix& matrix;
  const ScoreOptions& options;
  int radius_px;  ///< 0 when no surface is asked for.
  int threads;
  int margin_px = 0;  ///< Context of degraded copies.
  double center = 0;
  int lag_step = 1;
  std::vector<Degrader> copies{};
  std::optional<MatchabilityModel> model{};  ///< When P is asked for.
  GraySource shown{};                        ///< The map in 8 bits, with a model.
  double usual_contrast = 0;                 ///< What fine contrast is held against, with a model.

  bool clean() const;
  bool degraded() const;
};

/// Tiles whose pixels are read and transformed together, counted from the first tile of the map: a call for a part of a
/// block does so for all of it. 1 by 1 when no surface is asked for.
struct BlockSize {
  std::int64_t columns = 1;
  std::int64_t rows = 1;
};
BlockSize block_size(const TileScoring& scoring);

/// For all tiles that will be asked for. Arguments and exceptions are those of the other score_tiles; source, matrix
/// and options must outlive the result.
TileScoring begin_scoring(const GraySource& source, const TileMatrix& matrix, int search_radius_px,
                          std::span<const std::int64_t> tile_indices, const ScoreOptions& options, std::uint64_t seed,
                          int threads, const Progress& progress);

/// Scores some of these tiles, ascending, as the other score_tiles does.
std::vector<TileScores> score_tiles(const TileScoring& scoring, std::span<const std::int64_t> tile_indices,
                                    const Progress& progress);

}  // namespace pilotage
