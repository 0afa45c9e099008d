#include "pilotage/score/score_tiles.h"

#include <algorithm>

#include "pilotage/score/tile_scoring.h"

namespace pilotage {

bool ScoreOptions::measure(ScoreMeasure which) const {
  return std::find(measures.begin(), measures.end(), which) != measures.end();
}

bool ScoreOptions::measures_surface() const {
  return measure(ScoreMeasure::kUniqueness) || measure(ScoreMeasure::kDegraded);
}

std::vector<TileScores> score_tiles(const GraySource& source, const TileMatrix& matrix, int search_radius_px,
                                    std::span<const std::int64_t> tile_indices, const ScoreOptions& options,
                                    std::uint64_t seed, int threads, const Progress& progress) {
  const TileScoring scoring =
      begin_scoring(source, matrix, search_radius_px, tile_indices, options, seed, threads, progress);
  return score_tiles(scoring, tile_indices, progress);
}

}  // namespace pilotage
