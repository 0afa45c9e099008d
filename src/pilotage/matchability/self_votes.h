#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "pilotage/base/progress.h"
#include "pilotage/geo/tile_matrix.h"
#include "pilotage/raster/gray_source.h"
#include "pilotage/vision/features.h"

namespace pilotage {

/// What displacement voting has to win against at a tile, counted in the map's own features.
struct SelfVotes {
  /// Features inside the tile.
  std::int64_t features = 0;
  /// Standard deviation of the votes (3 × 3 px bins) over the displacements of the surroundings when the tile's own
  /// features vote: high where they look like each other, and highest where they repeat. NaN without a feature.
  double noise = std::numeric_limits<double>::quiet_NaN();
};

/// Votes of each tile's features for displacements within kVoteReach_px of the truth in both axes. A vote is a pair of
/// a feature of the tile and any of the map whose descriptors look alike (BinaryDescriptor::lookalike_distance). The
/// true peak, displacements up to 5 px, is left out. Nothing is degraded and nothing random; the votes that the true
/// place will get on another day are in proportion to `features`, the noise is what they must exceed
/// (docs/methods/matchability.md).
///
/// `options` are those of `build`, so that these are the map's features. Result i belongs to `tile_indices[i]`, where
/// index = row · matrix_width + column of `matrix`, whose pixel grid is that of `source` (CV_8U: stretch_to_8bit). The
/// reach does not depend on the search radius: the noise hardly does.
///
/// Streams bands of kFeatureBlockPx rows; in memory are the features and pairs of the bands that a row of tiles
/// touches. The result does not depend on `threads` (0 = all cores), nor on which other tiles are asked for. Throws
/// UsageError for an index out of range, and as extract_features_of_map; Interrupted.
std::vector<SelfVotes> count_self_votes(const GraySource& source, const TileMatrix& matrix,
                                        std::span<const std::int64_t> tile_indices, const FeatureOptions& options,
                                        int threads = 0, const Progress& progress = {});

inline constexpr int kVoteReach_px = 64;

}  // namespace pilotage
