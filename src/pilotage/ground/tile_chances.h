#pragma once

#include <cstddef>
#include <vector>

#include "pilotage/ground/tile_scores.h"

namespace pilotage {

/// select's is_matchable(): whether a plan may count on the tile.
bool can_be_matched(const TileScores& score, double min_p_correct_fix, double min_peak_margin);

/// Whether P of a correct fix of any tile is known.
bool any_p_known(const std::vector<TileScores>& scores);

/// P of a correct fix of each tile, 0 of one that is not counted on: over all that the level of the place may be, and
/// at each of the levels that a flight is predicted at. All tiles share the level: where one is found less often than
/// its P says, so are the others (ground/place_level.h).
struct TileChances {
  struct AtLevel {
    double weight = 1;
    std::vector<double> p;
  };
  std::vector<double> p;
  std::vector<AtLevel> levels;  ///< level_nodes(), or a single one where no tile has a level_sigma above 0.
};

/// Those of the tiles with `counts`; one without a P counts as certain.
TileChances tile_chances(const std::vector<TileScores>& scores, const std::vector<bool>& counts);

/// How many of those with `counts` have no P.
std::size_t tiles_without_p(const std::vector<TileScores>& scores, const std::vector<bool>& counts);

/// How many tiles of this ground, judged on another date, the level of those with `counts` rests on: the fewest,
/// because all of a ground are scored by one model; NaN where a P does not say.
double fewest_level_tiles(const std::vector<TileScores>& scores, const std::vector<bool>& counts);

/// Chances that are the same at any level.
TileChances level_free(std::vector<double> p_of_tile);

/// The same with 0 for the tiles that are not `chosen`.
TileChances of_chosen(TileChances chances, const std::vector<bool>& chosen);

}  // namespace pilotage
